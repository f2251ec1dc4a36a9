//! Meshes of boxes with disks in them.

use std::f64::consts::PI;

use nalgebra::{SVector, Vector2};

use super::{EdgeLengths, Mesh, Place, generate};
use crate::{
    body::pack,
    geometry::{Axis, Ball, Domain},
};

fn domain(size: [f64; 2], periodic: [bool; 2]) -> Domain<2> {
    let wall = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
    Domain { size: size.into(), axes: periodic.map(|periodic| if periodic { Axis::Periodic } else { wall }) }
}

fn disk(x: f64, y: f64, radius: f64) -> Ball<2> {
    Ball { center: Vector2::new(x, y), radius }
}

fn area(mesh: &Mesh) -> f64 {
    mesh.triangles.iter().flat_map(|triangle| mesh.shape(triangle).samples().unwrap()).map(|sample| sample.weight).sum()
}

/// The mesh fills what disks leave of the box, but for what parabolas miss of circles.
fn assert_sound(name: &str, mesh: &Mesh, longest: f64) {
    let disks: f64 = mesh.disks.iter().map(|disk| PI * disk.radius * disk.radius).sum();
    let missing = area(mesh) - (mesh.domain.volume() - disks);
    let bound: f64 = mesh.disks.iter().map(|disk| disk.radius * disk.radius * (longest / disk.radius).powi(4)).sum();
    assert!(missing.abs() <= 1e-2 * bound + 1e-12, "{name}: area is off by {missing:.1e}");
    assert!(mesh.smallest_angle().to_degrees() > 18.0, "{name}: an angle of {} degrees", mesh.smallest_angle().to_degrees());
    let edges = mesh.nodes.len() - mesh.vertices;
    let holes = (mesh.vertices + mesh.triangles.len()) as isize - edges as isize;
    let walled = (0..2).filter(|&axis| !mesh.domain.periodic(axis)).count() as isize;
    assert_eq!(holes, isize::from(walled == 2) - mesh.disks.len() as isize, "{name}: Euler's formula");
}

#[test]
fn meshes_fill_what_disks_leave_of_any_box() {
    for periodic in [[true, true], [true, false], [false, true], [false, false]] {
        for (size, disks, longest) in [
            ([1.0, 1.0], vec![], 0.1),
            ([1.0, 1.0], vec![disk(0.51, 0.52, 0.3)], 0.05),
            ([1.0, 1.0], vec![disk(0.51, 0.52, 0.3)], 0.1),
            ([1.0, 1.0], vec![disk(0.51, 0.52, 0.46)], 0.08),
            ([2.0, 1.0], vec![disk(0.4, 0.3, 0.2), disk(0.81, 0.3, 0.2), disk(1.6, 0.7, 0.1)], 0.03),
        ] {
            let domain = domain(size, periodic);
            let mesh = generate(&domain, &disks, longest).unwrap();
            assert_sound(&format!("{periodic:?} {size:?} {} disks", disks.len()), &mesh, longest);
        }
    }
    let periodic = domain([1.0, 1.0], [true, true]);
    let across = generate(&periodic, &[disk(0.02, 0.99, 0.3)], 0.05).unwrap();
    assert_sound("across the boundary", &across, 0.05);
}

#[test]
fn crowds_and_narrow_gaps_have_meshes_too() {
    for periodic in [[true, true], [true, false], [false, false]] {
        let domain = domain([1.0, 1.0], periodic);
        for (count, radius, gap, seed) in [(30, 0.0564, 0.05, 1), (60, 0.05, 0.02, 2), (12, 0.1, 0.01, 3)] {
            let centers = pack(&domain, &[], &vec![radius; count], gap, seed).unwrap();
            let disks: Vec<Ball<2>> = centers.into_iter().map(|center| Ball { center, radius }).collect();
            let mesh = generate(&domain, &disks, radius / 4.0).unwrap();
            assert_sound(&format!("{count} disks in {periodic:?}"), &mesh, radius / 4.0);
        }
    }
}

#[test]
fn edges_that_grow_make_few_triangles_and_as_many_as_told() {
    for periodic in [[true, true], [true, false], [false, false]] {
        let domain = domain([2.0, 3.0], periodic);
        let disks = [disk(0.7, 1.0, 0.125), disk(1.3, 2.0, 0.125)];
        let lengths = EdgeLengths::growing(0.03, &domain.size);
        let mesh = generate(&domain, &disks, lengths).unwrap();
        assert_sound(&format!("growing in {periodic:?}"), &mesh, 0.03);
        let squares = lengths.squares(domain.volume(), disks.iter().map(|disk| (disk.radius, 1.0)));
        let triangles = mesh.triangles.len() as f64;
        assert!(triangles < 0.3 * 2.309 * domain.volume() / 0.03_f64.powi(2), "{triangles} triangles");
        assert!((0.7..1.4).contains(&(triangles / (2.309 * squares))), "{triangles} triangles, {squares} squares");
        let on_disks = mesh.places[..mesh.vertices].iter().filter(|place| matches!(place, Place::Surface(_))).count() as f64;
        assert!(on_disks >= 2.0 * 2.0 * PI * 0.125 / 0.03, "{on_disks} vertices on disks");
    }
}

#[test]
fn a_gap_holds_three_elements_or_more() {
    for gap in [0.1, 0.02, 0.005, 0.001] {
        let domain = domain([6.0, 4.0], [true, false]);
        let disks = [disk(2.0, 2.0, 1.0), disk(4.0 + gap, 2.0, 1.0)];
        let mesh = generate(&domain, &disks, 0.2).unwrap();
        assert_sound(&format!("gap {gap}"), &mesh, 0.2);
        let samples = 1000;
        let mut crossed: Vec<usize> = (1..samples)
            .map(|sample| {
                let point = Vector2::new(3.0 + gap * f64::from(sample) / f64::from(samples), 2.0);
                let holds = |triangle| mesh.shape(triangle).locate(&point).is_some_and(|l| l.min() > -1e-9);
                mesh.triangles.iter().position(holds).unwrap_or(usize::MAX)
            })
            .collect();
        crossed.dedup();
        assert!(crossed.len() >= 3, "only {} elements across a gap of {gap}", crossed.len());
    }
}

#[test]
fn nodes_of_surfaces_lie_on_circles_and_nodes_of_walls_on_walls() {
    let domain = domain([2.0, 1.0], [true, false]);
    let mesh = generate(&domain, &[disk(0.1, 0.4, 0.25), disk(1.2, 0.6, 0.2)], 0.06).unwrap();
    let counts = mesh.nodes.iter().zip(&mesh.places).fold([0; 2], |[surfaces, walls], (node, place)| match place {
        Place::Fluid => [surfaces, walls],
        Place::Surface(disk) => {
            assert!((mesh.arm(*disk, node).norm() - mesh.disks[*disk].radius).abs() < 1e-14);
            [surfaces + 1, walls]
        }
        Place::Wall(on) => {
            assert_eq!(*on, [None, Some(node.y > 0.5)]);
            assert!(node.y == 0.0 || node.y == 1.0);
            [surfaces, walls + 1]
        }
    });
    assert!(counts[0] > 40 && counts[1] > 100, "{counts:?}");
}
