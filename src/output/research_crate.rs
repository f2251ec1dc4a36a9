//! `ro-crate-metadata.json`: how a run came about and what its folder holds, as an RO-Crate.
//!
//! It follows RO-Crate 1.1 and the Process Run Crate profile 0.5: the program is the instrument of an action, whose objects are the scene and its tables, and whose
//! results are the files of the run, with their sizes and SHA-256 checksums. The licence of the data is that of their owner, whom the program does not know.
//! Sources: <https://www.researchobject.org/ro-crate/specification/1.1/>, S. Leo et al., 2024, doi:10.1371/journal.pone.0309210.

use std::{
    fs,
    io::{self, Read},
    path::Path,
    time::SystemTime,
};

use serde_json::{Value, json};
use sha2::{Digest, Sha256};

use super::{
    clock::iso_date,
    files::{checksum::sums_of_all, file::write_whole},
    summary::Summary,
    traces::{CRATE, KNOWN_FILES, SUMMARY, Traces},
};
use crate::{
    error::{Error, Result},
    parallel::{Machine, World},
};

/// Identifiers of the specification, of the profile and of the terms that it adds.
const SPECIFICATION: &str = "https://w3id.org/ro/crate/1.1";
const PROFILE: &str = "https://w3id.org/ro/wfrun/process/0.5";
const TERMS: &str = "https://w3id.org/ro/terms/workflow-run/context";

/// What stands in place of a licence.
const LICENCE: &str =
    "No licence is stated: the program that wrote this folder does not know the owner of the data, who may grant one here.";

/// Bytes that are read at once.
const AT_ONCE: usize = 1 << 20;

/// Words of a checksum.
const WORDS: usize = 4;

/// A run that has ended.
pub struct RunRecord<'a> {
    /// Its numbers.
    pub summary: &'a Summary,
    /// The text of its summary, which is written after the metadata.
    pub text: &'a str,
    /// The command line.
    pub command: String,
    /// When the program began.
    pub begun: SystemTime,
    /// Names of the scene and its tables in the folder.
    pub inputs: Vec<String>,
}

/// A file of the folder.
struct CrateFile {
    name: String,
    bytes: u64,
    checksum: [u64; WORDS],
}

/// Writes the metadata of a folder. Each rank reads its share of the files. Collective.
///
/// # Errors
/// [`Error::File`] when a file cannot be read or written.
pub fn write_crate(world: &World, folder: &Path, run: &RunRecord) -> Result<()> {
    let names = world.on_first_rank(|| Ok(names(folder, &run.inputs)?.join("\n")))?;
    let names: Vec<String> = world.broadcast(0, &names).lines().map(str::to_owned).collect();
    let mut parts = parts(world, folder, names)?;
    world.on_first_rank(|| {
        parts.push(CrateFile {
            name: SUMMARY.to_owned(),
            bytes: run.text.len() as u64,
            checksum: words(Sha256::digest(run.text.as_bytes()).as_slice()),
        });
        let json = serde_json::to_string_pretty(&metadata(run, &parts)).expect("metadata are plain text");
        write_whole(&folder.join(CRATE), json.as_bytes())
    })
}

/// Names of the files of the run in the folder, inputs first.
fn names(folder: &Path, inputs: &[String]) -> Result<Vec<String>> {
    let mut names = Traces::of(folder)?.names();
    names.sort();
    names.retain(|name| !inputs.contains(name) && name != CRATE && name != SUMMARY && !name.ends_with(".part"));
    let there = inputs.iter().filter(|name| folder.join(name).exists()).cloned();
    Ok(there.chain(names).collect())
}

/// Sizes and checksums, known to all ranks.
fn parts(world: &World, folder: &Path, names: Vec<String>) -> Result<Vec<CrateFile>> {
    let own = |place: usize| place % world.size() == world.rank();
    let measure = |(place, name): (usize, &String)| {
        let path = folder.join(name);
        if own(place) { measured(&path).map_err(|source| Error::File { path, source }) } else { Ok([0; WORDS + 1]) }
    };
    let numbers = world.agree(names.iter().enumerate().map(measure).collect::<Result<Vec<_>>>())?;
    let all = sums_of_all(world, &numbers.concat());
    let part =
        |(name, numbers): (String, &[u64])| CrateFile { name, bytes: numbers[0], checksum: std::array::from_fn(|word| numbers[word + 1]) };
    Ok(names.into_iter().zip(all.chunks_exact(WORDS + 1)).map(part).collect())
}

/// The size of a file and its checksum.
fn measured(path: &Path) -> io::Result<[u64; WORDS + 1]> {
    let (mut file, mut sum, mut bytes, mut buffer) = (fs::File::open(path)?, Sha256::new(), 0, vec![0; AT_ONCE]);
    loop {
        let count = file.read(&mut buffer)?;
        if count == 0 {
            break;
        }
        bytes += count as u64;
        sum.update(&buffer[..count]);
    }
    let words = words(sum.finalize().as_slice());
    Ok(std::array::from_fn(|place| if place == 0 { bytes } else { words[place - 1] }))
}

fn words(digest: &[u8]) -> [u64; WORDS] {
    std::array::from_fn(|word| digest[8 * word..8 * word + 8].iter().fold(0, |number, &byte| number << 8 | u64::from(byte)))
}

fn metadata(run: &RunRecord, parts: &[CrateFile]) -> Value {
    let ids = |input: bool| -> Vec<Value> {
        parts.iter().filter(|part| run.inputs.contains(&part.name) == input).map(|part| json!({ "@id": part.name })).collect()
    };
    let all = [ids(true), ids(false)].concat();
    let end = iso_date(SystemTime::now());
    let Summary { scene, title, version, .. } = run.summary;
    let name = if title.is_empty() { scene } else { title };
    let mut graph = vec![
        json!({ "@id": CRATE, "@type": "CreativeWork", "conformsTo": { "@id": SPECIFICATION }, "about": { "@id": "./" } }),
        json!({ "@id": "./", "@type": "Dataset", "conformsTo": { "@id": PROFILE }, "name": name,
            "description": format!("A simulation of particles in viscous flow by turbid {version}: the scene {scene}"),
            "datePublished": end, "license": LICENCE, "hasPart": all, "mentions": { "@id": "#run" } }),
        json!({ "@id": PROFILE, "@type": "CreativeWork", "name": "Process Run Crate", "version": "0.5" }),
        json!({ "@id": "#turbid", "@type": "SoftwareApplication", "name": "turbid", "softwareVersion": version,
            "description": concat!("with ", env!("TURBID_LIBRARIES")) }),
        machine(run.summary.ranks),
        json!({ "@id": "#run", "@type": "CreateAction", "name": format!("run of {scene}"), "description": run.command,
            "instrument": { "@id": "#turbid" }, "location": { "@id": "#machine" }, "object": references(ids(true)), "result": references(ids(false)),
            "startTime": iso_date(run.begun), "endTime": end, "actionStatus": "http://schema.org/CompletedActionStatus" }),
    ];
    graph.extend(parts.iter().map(entity));
    json!({ "@context": [format!("{SPECIFICATION}/context"), TERMS], "@graph": graph })
}

/// One thing stands alone in JSON-LD, several in a list.
fn references(ids: Vec<Value>) -> Value {
    <[Value; 1]>::try_from(ids).map_or_else(Value::Array, |[id]| id)
}

/// Where the run took place.
fn machine(ranks: usize) -> Value {
    let Machine { name, processor, cores, .. } = Machine::local();
    let processor = processor.map_or(String::new(), |processor| format!(" ({processor})"));
    let description = format!("{ranks} MPI ranks; the first one on a machine with {cores} cores{processor}, {}", std::env::consts::ARCH);
    json!({ "@id": "#machine", "@type": "Place", "name": name, "description": description })
}

fn entity(part: &CrateFile) -> Value {
    let what = KNOWN_FILES.iter().find(|(name, _)| *name == part.name).map_or("a file of the run", |(_, what)| what);
    let checksum: String = part.checksum.iter().map(|word| format!("{word:016x}")).collect();
    json!({ "@id": part.name, "@type": "File", "name": part.name, "description": what, "encodingFormat": format_of(&part.name),
        "contentSize": part.bytes.to_string(), "sha256": checksum })
}

/// The media type of a file.
fn format_of(name: &str) -> &'static str {
    match Path::new(name).extension().and_then(|ending| ending.to_str()) {
        Some("h5" | "vtkhdf") => "application/x-hdf5",
        Some("json") => "application/json",
        Some("csv") => "text/csv",
        Some("toml") => "application/toml",
        Some("svg") => "image/svg+xml",
        Some("png") => "image/png",
        Some("html") => "text/html",
        Some("xdmf") => "application/xml",
        _ => "text/plain",
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn a_checksum_is_that_of_the_standard() {
        let path = std::env::temp_dir().join(format!("turbid-crate-{}", std::process::id()));
        fs::write(&path, "abc").unwrap();
        // FIPS 180-4, appendix of examples
        let expected = [0xba78_16bf_8f01_cfea, 0x4141_40de_5dae_2223, 0xb003_61a3_9617_7a9c, 0xb410_ff61_f200_15ad];
        assert_eq!(measured(&path).unwrap(), [3, expected[0], expected[1], expected[2], expected[3]]);
        fs::remove_file(&path).unwrap();
    }
}
