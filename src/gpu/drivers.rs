//! Vulkan drivers that the loader is told of and cannot load: files that name a library which is not there, or is none of this
//! machine.

use goblin::elf::{Elf, header};
use std::env;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

/// A driver's file and what is wrong with it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DriverFault {
    /// The file.
    pub file: PathBuf,
    /// Why the driver cannot be loaded.
    pub reason: String,
}

/// The files of drivers that cannot be loaded, where the Vulkan loader of Linux looks for them: those that VK_DRIVER_FILES names,
/// else those of VK_ICD_FILENAMES, else the usual folders; and those of VK_ADD_DRIVER_FILES. None on other systems.
pub fn driver_faults() -> Vec<DriverFault> {
    if !cfg!(target_os = "linux") {
        return Vec::new();
    }
    let variable = |name: &str| env::var_os(name).filter(|value| !value.is_empty());
    let fault = |file: PathBuf| fault(&file, &variable).map(|reason| DriverFault { file, reason });
    files(&variable).into_iter().filter_map(fault).collect()
}

type Variable<'a> = &'a dyn Fn(&str) -> Option<OsString>;

/// The files that the loader reads. What a variable names must be there; folders may be missing.
fn files(variable: Variable) -> Vec<PathBuf> {
    let named = |name: &str| variable(name).iter().flat_map(env::split_paths).collect::<Vec<_>>();
    let chosen = ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"].into_iter().find(|name| variable(name).is_some());
    let mut places = named("VK_ADD_DRIVER_FILES");
    match chosen {
        Some(name) => places.extend(named(name)),
        None => places.extend(folders(variable)),
    }
    let mut files: Vec<PathBuf> = Vec::new();
    for place in places.into_iter().filter(|place| !place.as_os_str().is_empty()) {
        if !place.is_dir() {
            files.push(place);
            continue;
        }
        let inside = fs::read_dir(&place).into_iter().flatten().flatten().map(|entry| entry.path());
        let mut inside: Vec<PathBuf> = inside.filter(|path| path.extension().is_some_and(|is| is == "json")).collect();
        inside.sort();
        files.extend(inside);
    }
    files
}

/// The usual folders that are there.
fn folders(variable: Variable) -> Vec<PathBuf> {
    let paths = |name: &str, usual: &str| -> Vec<PathBuf> {
        env::split_paths(&variable(name).unwrap_or_else(|| usual.into())).collect()
    };
    let home = variable("HOME").map(PathBuf::from).unwrap_or_default();
    let of_home = |name: &str, usual: &str| variable(name).map_or_else(|| home.join(usual), PathBuf::from);
    let mut roots = vec![of_home("XDG_CONFIG_HOME", ".config")];
    roots.extend(paths("XDG_CONFIG_DIRS", "/etc/xdg"));
    roots.extend(["/usr/local/etc", "/etc"].map(PathBuf::from));
    roots.push(of_home("XDG_DATA_HOME", ".local/share"));
    roots.extend(paths("XDG_DATA_DIRS", "/usr/local/share:/usr/share"));
    roots.into_iter().map(|root| root.join("vulkan/icd.d")).filter(|folder| folder.is_dir()).collect()
}

/// Why the driver of a file cannot be loaded, if so.
fn fault(file: &Path, variable: Variable) -> Option<String> {
    let text = match fs::read(file) {
        Ok(text) => text,
        Err(error) => return Some(format!("the file cannot be read: {error}")),
    };
    let value: serde_json::Value = match serde_json::from_slice(&text) {
        Ok(value) => value,
        Err(error) => return Some(format!("the file is not JSON: {error}")),
    };
    let Some(name) = value["ICD"]["library_path"].as_str() else {
        return Some("the file names no library_path".into());
    };
    // A path is relative to its file; a name alone is looked up as those of all libraries are.
    let library = if name.contains('/') {
        Some(file.parent().unwrap_or(Path::new("")).join(name)).filter(|path| path.is_file())
    } else {
        look_up(name, variable)
    };
    match library {
        None => Some(format!("its library {name} is not there")),
        Some(path) => unsuited(&path, variable),
    }
}

/// The library of a name.
fn look_up(name: &str, variable: Variable) -> Option<PathBuf> {
    let roots = ["/lib", "/usr/lib", "/lib64", "/usr/lib64", "/usr/local/lib"].map(PathBuf::from);
    // Debian's folders carry the name of the machine.
    let triplet = format!("{}-linux-gnu", env::consts::ARCH);
    let own = roots.clone().map(|root| root.join(&triplet));
    let told: Vec<PathBuf> = variable("LD_LIBRARY_PATH").iter().flat_map(env::split_paths).collect();
    let folders = told.into_iter().chain(own).chain(roots);
    folders.map(|folder| folder.join(name)).find(|path| path.is_file()).or_else(|| cached(name))
}

/// The library of a name in the loader's cache, a file with many strings that end with a zero.
fn cached(name: &str) -> Option<PathBuf> {
    let cache = fs::read("/etc/ld.so.cache").ok()?;
    let ends = format!("/{name}");
    let mut strings = cache.split(|byte| *byte == 0).filter_map(|bytes| std::str::from_utf8(bytes).ok());
    strings.find(|text| text.starts_with('/') && text.ends_with(&ends)).map(PathBuf::from)
}

/// Why a library cannot be loaded by a program of this machine, if so. Drivers for another machine are none of its business.
fn unsuited(library: &Path, variable: Variable) -> Option<String> {
    let bytes = match fs::read(library) {
        Ok(bytes) => bytes,
        Err(error) => return Some(format!("its library {} cannot be read: {error}", library.display())),
    };
    let Ok(elf) = Elf::parse(&bytes) else {
        return Some(format!("its library {} is no library", library.display()));
    };
    let machine = match env::consts::ARCH {
        "x86_64" => header::EM_X86_64,
        "aarch64" => header::EM_AARCH64,
        "riscv64" => header::EM_RISCV,
        _ => return None,
    };
    // Folders of its own may have what is nowhere else.
    let searches = !elf.rpaths.is_empty() || !elf.runpaths.is_empty();
    if searches || !elf.is_64 || elf.header.e_machine != machine {
        return None;
    }
    let missing: Vec<&str> = elf.libraries.into_iter().filter(|name| look_up(name, variable).is_none()).collect();
    let needs = || format!("its library {} needs {}, which is not there", library.display(), missing.join(" and "));
    (!missing.is_empty()).then(needs)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file of a driver in a folder, and what is wrong with it.
    fn of_text(folder: &Path, text: &str) -> Option<String> {
        let file = folder.join("driver.json");
        fs::write(&file, text).expect("it can be written");
        fault(&file, &|_| None)
    }

    fn of_library(folder: &Path, library: &str) -> Option<String> {
        of_text(folder, &format!("{{\"ICD\": {{\"library_path\": \"{library}\"}}}}"))
    }

    #[test]
    fn a_driver_that_cannot_be_loaded_is_told_with_the_reason() {
        let folder = tempfile::tempdir().expect("a folder");
        let folder = folder.path();
        let said = |fault: Option<String>, reason: &str| {
            let fault = fault.unwrap_or_else(|| panic!("nothing is said, but: {reason}"));
            assert!(fault.contains(reason), "{fault}");
        };
        said(fault(&folder.join("none.json"), &|_| None), "the file cannot be read: No such file");
        said(of_text(folder, "ICD"), "the file is not JSON");
        said(of_text(folder, "{\"ICD\": {}}"), "the file names no library_path");
        said(of_library(folder, "./libnone.so"), "its library ./libnone.so is not there");
        said(of_library(folder, "libnone-at-all.so"), "its library libnone-at-all.so is not there");
        fs::write(folder.join("libtext.so"), "text").expect("it can be written");
        said(of_library(folder, "./libtext.so"), "libtext.so is no library");
    }

    #[test]
    fn a_library_is_sound_until_something_that_it_needs_is_gone() {
        let folder = tempfile::tempdir().expect("a folder");
        let libc = look_up("libc.so.6", &|_| None).expect("Linux has one");
        let mut bytes = fs::read(libc).expect("it can be read");
        let library = folder.path().join("libcopy.so");
        fs::write(&library, &bytes).expect("it can be written");
        assert_eq!(of_library(folder.path(), "./libcopy.so"), None);
        // libc needs the dynamic loader; a copy that needs another is not to be had.
        let needed = Elf::parse(&bytes).expect("it is a library").libraries.remove(0).to_owned();
        let places: Vec<usize> =
            (0..bytes.len() - needed.len()).filter(|at| bytes[*at..].starts_with(needed.as_bytes())).collect();
        places.into_iter().for_each(|at| bytes[at] = b'X');
        fs::write(&library, &bytes).expect("it can be written");
        let fault = of_library(folder.path(), "./libcopy.so").expect("it cannot be loaded");
        assert!(fault.ends_with(&format!("needs X{}, which is not there", &needed[1..])), "{fault}");
        // No damage makes it more than a fault or a library for somebody else.
        for cut in [0, 3, 20, 60, 200, 5000, bytes.len() - 9] {
            fs::write(&library, &bytes[..cut]).expect("it can be written");
            of_library(folder.path(), "./libcopy.so");
        }
    }

    #[test]
    fn files_are_those_of_the_variables_or_of_the_usual_folders() {
        let home = tempfile::tempdir().expect("a folder");
        let usual = home.path().join("data/vulkan/icd.d");
        fs::create_dir_all(&usual).expect("it can be made");
        for name in ["b.json", "a.json", "c.txt"] {
            fs::write(usual.join(name), "").expect("it can be written");
        }
        let found = |set: &[(&str, &str)]| {
            let text = |name: &str| set.iter().find(|(known, _)| *known == name).map(|(_, text)| OsString::from(text));
            files(&|name| match name {
                "XDG_DATA_DIRS" => Some(home.path().join("data").into_os_string()),
                "HOME" | "XDG_CONFIG_DIRS" => Some("/nonexistent".into()),
                name => text(name),
            })
        };
        let mut all = found(&[]);
        all.retain(|file| file.starts_with(home.path()));
        assert_eq!(all, [usual.join("a.json"), usual.join("b.json")]);
        assert_eq!(found(&[("VK_ICD_FILENAMES", "/x:/y")]), ["/x", "/y"].map(PathBuf::from));
        assert_eq!(found(&[("VK_ICD_FILENAMES", "/x"), ("VK_DRIVER_FILES", "/z")]), ["/z"].map(PathBuf::from));
        let added = found(&[("VK_ADD_DRIVER_FILES", "/w"), ("VK_DRIVER_FILES", "/z")]);
        assert_eq!(added, ["/w", "/z"].map(PathBuf::from));
    }
}
