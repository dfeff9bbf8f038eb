//! Files are written whole or not at all.

use std::io::Write as _;
use std::path::Path;

/// A file that cannot be written.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cannot write {path}: {reason}")]
pub struct WriteError {
    /// The file or folder.
    pub path: String,
    /// Why, and the way out.
    pub reason: String,
}

impl WriteError {
    /// What the system says of a path.
    pub fn new(path: &Path, error: &std::io::Error) -> Self {
        Self { path: path.display().to_string(), reason: without_path(error) }
    }
}

/// Writes a file under a temporary name in the same folder, then renames it: whatever fails, a file that was
/// there before stays, and none is left half written.
///
/// # Errors
/// If it cannot be written; the message names the way out.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    write_with(path, |file| file.write_all(bytes))
}

fn write_with(
    path: &Path,
    fill: impl FnOnce(&mut std::fs::File) -> std::io::Result<()>,
) -> Result<(), WriteError> {
    let refused = |reason: String| WriteError { path: path.display().to_string(), reason };
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    // Renaming over a device such as /dev/null would replace it.
    match path.metadata() {
        Ok(there) if there.is_dir() => return Err(refused("it is a folder; add the name of a file".into())),
        Ok(there) if !there.is_file() => return Err(refused("it is a device; name a file".into())),
        _ => {}
    }
    let failed = |error: std::io::Error| {
        use std::io::ErrorKind;
        let way_out = match error.kind() {
            ErrorKind::NotFound => format!("; make the folder {} first", folder.display()),
            ErrorKind::NotADirectory => format!("; {} is not a folder", folder.display()),
            ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
                format!("; choose a folder other than {}, or change its permissions", folder.display())
            }
            ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge => {
                format!("; make room in {}, or choose another folder", folder.display())
            }
            _ => String::new(),
        };
        refused(format!("{}{way_out}", without_path(&error)))
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".gonio-");
    // Temporary files are private to their owner; a result is for everyone whom the umask allows.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(folder).map_err(failed)?;
    fill(file.as_file_mut()).map_err(failed)?;
    // Without it a rename can reach the disk before the contents do.
    file.as_file().sync_all().map_err(failed)?;
    file.persist(path).map_err(|error| failed(error.error))?;
    Ok(())
}

/// What the system says; `tempfile` adds the temporary path, which means nothing to anyone.
fn without_path(error: &std::io::Error) -> String {
    let text = error.to_string();
    text.split_once(" at path ").map_or(text.clone(), |(reason, _)| reason.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;
    use std::io::{Error, ErrorKind};

    #[test]
    fn files_are_replaced_whole_or_not_at_all() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        write(&path, b"one").unwrap();
        write(&path, b"two").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"two");
        let error = write_with(&path, |file| {
            file.write_all(b"half of th")?;
            Err(Error::from(ErrorKind::StorageFull))
        });
        let expected = format!("; make room in {}, or choose another folder", folder.path().display());
        let error = error.unwrap_err().to_string();
        assert!(error.starts_with(&format!("cannot write {}: ", path.display())), "{error}");
        assert!(error.ends_with(&expected), "{error}");
        assert_eq!(fs::read(&path).unwrap(), b"two");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "a temporary file is left");
    }

    #[cfg(unix)]
    #[test]
    fn a_file_can_be_read_by_those_whom_the_umask_allows() {
        use std::os::unix::fs::PermissionsExt as _;
        let folder = tempfile::tempdir().unwrap();
        let mode = |name: &str| fs::metadata(folder.path().join(name)).unwrap().permissions().mode();
        write(&folder.path().join("a"), b"one").unwrap();
        fs::write(folder.path().join("b"), b"one").unwrap();
        assert_eq!(mode("a"), mode("b"));
    }

    #[test]
    fn places_that_cannot_be_written_are_named_with_the_way_out() {
        let folder = tempfile::tempdir().unwrap();
        let complaint = |path: &Path, expected: &str| {
            let error = write(path, b"one").unwrap_err().to_string();
            assert!(error.starts_with(&format!("cannot write {}: ", path.display())), "{error}");
            assert!(error.contains(expected) && !error.contains(".gonio-"), "{error}");
        };
        complaint(&folder.path().join("missing/a.png"), "missing first");
        complaint(folder.path(), "it is a folder; add the name of a file");
        write(&folder.path().join("a.png"), b"one").unwrap();
        complaint(&folder.path().join("a.png/b.png"), "a.png is not a folder");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        #[cfg(unix)]
        {
            complaint(Path::new("/dev/null"), "it is a device");
            use std::os::unix::fs::PermissionsExt as _;
            let closed = folder.path().join("closed");
            fs::create_dir(&closed).unwrap();
            fs::set_permissions(&closed, fs::Permissions::from_mode(0o500)).unwrap();
            // The superuser may write everywhere.
            if fs::write(closed.join("probe"), b"").is_err() {
                complaint(&closed.join("a.png"), "closed, or change its permissions");
            }
        }
    }
}
