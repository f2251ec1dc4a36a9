//! XDMF 3: how ParaView finds its way through the frames. Orders of axes are slowest first, as in the files.

use std::{
    fs,
    io::{self, Seek, SeekFrom, Write},
    path::Path,
};

use super::{
    body, bond, contact,
    entry::{Entry, path_in_run},
    listing::Format,
    membrane,
    store::field_columns,
};

/// What ends every companion.
const END: &str = "</Grid>\n</Domain>\n</Xdmf>\n";

/// A file that shows one kind of thing, frame after frame.
pub(super) struct Companion {
    /// Name of the file.
    pub name: &'static str,
    /// Name of what it shows.
    title: &'static str,
    /// Whether a frame has any of it.
    shown: fn(&Entry) -> bool,
    /// What it shows of a frame.
    grid: fn(&Entry) -> String,
}

/// The bodies as points that move; the contacts as points, with their normals and forces; bonds as lines; membranes as surfaces; the fields on the cells.
pub(super) const COMPANIONS: [Companion; 5] = [
    Companion { name: "bodies.xdmf", title: "bodies", shown: |entry| entry.bodies > 0, grid: cloud },
    Companion {
        name: "contacts.xdmf",
        title: "contacts",
        shown: |entry| entry.contacts.is_some_and(|network| network.count > 0),
        grid: network,
    },
    Companion { name: "bonds.xdmf", title: "bonds", shown: |entry| entry.bonds > 0, grid: lines },
    Companion { name: "membranes.xdmf", title: "membranes", shown: |entry| entry.membranes.is_some(), grid: surfaces },
    Companion { name: "fields.xdmf", title: "fields", shown: |entry| entry.mesh.is_some(), grid: lattice },
];

impl Companion {
    fn grids(&self, entries: &[&Entry]) -> String {
        entries.iter().map(|entry| (self.grid)(entry)).collect::<String>() + END
    }
}

impl Format for Companion {
    fn empty(&self) -> bool {
        false
    }

    fn lists(&self, entry: &Entry) -> bool {
        (self.shown)(entry)
    }

    fn create(&self, path: &Path, entries: &[&Entry]) -> io::Result<()> {
        let begin = format!(
            "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n<Domain>\n<Grid Name=\"{}\" GridType=\"Collection\" CollectionType=\"Temporal\">\n",
            self.title
        );
        fs::write(path, begin + &self.grids(entries))
    }

    fn append(&self, path: &Path, entries: &[&Entry]) -> io::Result<()> {
        let mut file = fs::File::options().write(true).open(path)?;
        file.seek(SeekFrom::End(-(END.len() as i64)))?;
        file.write_all(self.grids(entries).as_bytes())
    }
}

fn cloud(entry: &Entry) -> String {
    points(entry, "bodies", entry.bodies, "center", body::at_centers())
}

fn network(entry: &Entry) -> String {
    let (count, present) = entry.contacts.map_or((0, [false; 2]), |network| (network.count, network.present));
    let optional = contact::OPTIONAL.into_iter().zip(present).filter(|(_, present)| *present).map(|(column, _)| column);
    let columns = contact::COLUMNS.into_iter().filter(|(name, _)| *name != "point").chain(optional);
    let counts = contact::COUNTS.iter().filter(|(_, width)| *width == 1).map(|&(name, width)| (name, width, false));
    points(entry, "contacts", count, "point", columns.map(|(name, width)| (name, width, true)).chain(counts))
}

/// A cloud of points in the columns of a group: where they are, and names, widths and kinds (real or whole) of what they carry.
fn points(entry: &Entry, group: &str, count: usize, place: &str, columns: impl Iterator<Item = (&'static str, usize, bool)>) -> String {
    let item = |name: &str, width: usize, real: bool| {
        let shape = if width == 1 { vec![count] } else { vec![count, width] };
        data_item(entry, &format!("{group}/{name}"), &shape, real)
    };
    let attributes: String = columns.map(|(name, width, real)| attribute(name, width, "Node", &item(name, width, real))).collect();
    let topology = format!("<Topology TopologyType=\"Polyvertex\" NumberOfElements=\"{count}\" NodesPerElement=\"1\"/>\n");
    let geometry = format!("<Geometry GeometryType=\"XYZ\">{}</Geometry>\n", item(place, 3, true));
    grid(entry, &format!("{topology}{geometry}{attributes}"))
}

fn lines(entry: &Entry) -> String {
    let (bonds, ends) = (entry.bonds, 2 * entry.bonds);
    let item = |name: &str, shape: &[usize], real: bool| data_item(entry, &format!("bonds/{name}"), shape, real);
    let nodes = item(bond::NODE, &[ends], false);
    let topology = format!("<Topology TopologyType=\"Polyline\" NumberOfElements=\"{bonds}\" NodesPerElement=\"2\">{nodes}</Topology>\n");
    let geometry = format!("<Geometry GeometryType=\"XYZ\">{}</Geometry>\n", item("point", &[ends, 3], true));
    let attributes: String =
        bond::COUNTS.iter().map(|(name, width)| attribute(name, *width, "Node", &item(name, &[ends], false))).collect();
    grid(entry, &format!("{topology}{geometry}{attributes}"))
}

fn surfaces(entry: &Entry) -> String {
    let Some(membranes) = &entry.membranes else { return String::new() };
    let item = |name: &str, shape: &[usize], real: bool| data_item(entry, &format!("membranes/{name}"), shape, real);
    let faces = data_item(entry, &format!("faces/{}", membrane::TOPOLOGY), &[membranes.topology], false);
    let topology = format!("<Topology TopologyType=\"Mixed\" NumberOfElements=\"{}\">{faces}</Topology>\n", membranes.faces);
    let geometry = format!("<Geometry GeometryType=\"XYZ\">{}</Geometry>\n", item("point", &[membranes.corners, 3], true));
    let numbers = membrane::COUNTS.iter().map(|(name, width)| attribute(name, *width, "Node", &item(name, &[membranes.corners], false)));
    grid(entry, &format!("{topology}{geometry}{}", numbers.collect::<String>()))
}

fn lattice(entry: &Entry) -> String {
    let Some(mesh) = &entry.mesh else { return String::new() };
    let (cells, origin, spacing) = mesh.in_space();
    let topology = format!("<Topology TopologyType=\"3DCoRectMesh\" Dimensions=\"{}\"/>\n", words(cells.map(|cells| cells + 1)));
    let numbers = |numbers: [f64; 3]| {
        format!("<DataItem Format=\"XML\" NumberType=\"Float\" Precision=\"8\" Dimensions=\"3\">{}</DataItem>", words(numbers))
    };
    let geometry = format!("<Geometry GeometryType=\"ORIGIN_DXDYDZ\">{}{}</Geometry>\n", numbers(origin), numbers(spacing));
    let attributes = field_columns(mesh.cells.len(), mesh.vorticity).into_iter().map(|(name, width)| {
        let shape: Vec<usize> = cells.into_iter().chain((width > 1).then_some(width)).collect();
        attribute(name, width, "Cell", &data_item(entry, &format!("fields/{name}"), &shape, true))
    });
    let attributes: String = attributes.collect();
    grid(entry, &format!("{topology}{geometry}{attributes}"))
}

fn grid(entry: &Entry, contents: &str) -> String {
    let offset = entry.offset.map(|offset| attribute("offset", 1, "Grid", &number(offset))).unwrap_or_default();
    format!("<Grid Name=\"{:06}\" GridType=\"Uniform\">\n<Time Value=\"{:?}\"/>\n{contents}{offset}</Grid>\n", entry.number, entry.time)
}

fn number(number: f64) -> String {
    format!("<DataItem Format=\"XML\" NumberType=\"Float\" Precision=\"8\" Dimensions=\"1\">{number:?}</DataItem>")
}

fn attribute(name: &str, width: usize, center: &str, item: &str) -> String {
    let kind = match width {
        1 => "Scalar",
        3 => "Vector",
        _ => "Tensor",
    };
    format!("<Attribute Name=\"{name}\" AttributeType=\"{kind}\" Center=\"{center}\">{item}</Attribute>\n")
}

fn data_item(entry: &Entry, path: &str, shape: &[usize], real: bool) -> String {
    let (shape, file) = (words(shape), path_in_run(entry.number));
    let kind = if real { "NumberType=\"Float\" Precision=\"8\"" } else { "NumberType=\"Int\" Precision=\"4\"" };
    format!("<DataItem Format=\"HDF\" {kind} Dimensions=\"{shape}\">{file}:/{path}</DataItem>")
}

/// Numbers with blanks between them; floating-point ones with all their digits.
fn words<T: std::fmt::Debug>(numbers: impl IntoIterator<Item = T>) -> String {
    numbers.into_iter().map(|number| format!("{number:?}")).collect::<Vec<_>>().join(" ")
}
