//! Coulomb's cone, and how far forces are from the exact law (De Saxce and Feng 1998, doi:10.1016/S0895-7177(98)00119-8).
//!
//! `K = { |r_T| <= mu r_N }` contains the force of a contact, its dual `K* = { u_N >= mu |u_T| }` the velocity `u + mu |u_T| e_N`, and both are
//! orthogonal. That holds just if the natural map `r - P_K(r - u - mu |u_T| e_N)` is zero. By the convex law (Anitescu and Tasora 2010,
//! doi:10.1007/s10589-008-9223-4) `u` itself is in the dual cone: a contact that slips opens. Components: the normal one, then tangential ones.

/// The size of the tangential part.
#[inline]
pub fn tangential_size(vector: &[f64]) -> f64 {
    vector[1..].iter().map(|component| component * component).sum::<f64>().sqrt()
}

/// The point of the cone that is next to a force.
#[inline]
pub fn project<const D: usize>(force: [f64; D], friction: f64) -> [f64; D] {
    let size = tangential_size(&force);
    if size <= friction * force[0] {
        return force;
    }
    if friction * size <= -force[0] {
        return [0.0; D];
    }
    let normal = (force[0] + friction * size) / (1.0 + friction * friction);
    std::array::from_fn(|axis| if axis == 0 { normal } else { friction * normal * force[axis] / size })
}

/// The largest component of the natural map of a force and a velocity, in rows of the same unit, with a coefficient and with what of a slip may open a contact.
#[inline]
pub fn natural_map<const D: usize>(force: &[f64; D], velocity: &[f64; D], friction: f64, dilation: f64) -> f64 {
    let mut aim: [f64; D] = std::array::from_fn(|axis| force[axis] - velocity[axis]);
    aim[0] -= (friction - dilation) * tangential_size(velocity);
    let next = project(aim, friction);
    force.iter().zip(next).map(|(force, next)| (force - next).abs()).fold(0.0, larger)
}

/// The larger of two numbers, which is none if the second one is none.
#[inline]
pub fn larger(one: f64, other: f64) -> f64 {
    if other > one || other.is_nan() { other } else { one }
}

/// What a contact does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ContactState {
    /// It bears no force.
    Open,
    /// Its surfaces do not slide.
    Sticking,
    /// They do.
    Slipping,
}

impl ContactState {
    /// That of a force and a velocity, in rows of the same unit (Alart and Curnier 1991, doi:10.1016/0045-7825(91)90022-X).
    pub fn of<const D: usize>(force: &[f64; D], velocity: &[f64; D], friction: f64) -> ContactState {
        let aim: [f64; D] = std::array::from_fn(|axis| force[axis] - velocity[axis]);
        match aim[0] {
            normal if normal <= 0.0 => ContactState::Open,
            normal if tangential_size(&aim) <= friction * normal => ContactState::Sticking,
            _ => ContactState::Slipping,
        }
    }

    /// That of a force less a velocity by the convex law: where its projection on the cone lies.
    pub fn by_projection<const D: usize>(aim: &[f64; D], friction: f64) -> ContactState {
        match tangential_size(aim) {
            size if friction * size <= -aim[0] => ContactState::Open,
            size if size <= friction * aim[0] => ContactState::Sticking,
            _ => ContactState::Slipping,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_force_is_projected_on_the_cone_on_its_axis_or_on_its_tip() {
        assert_eq!(project([2.0, 0.5, -0.5], 0.5), [2.0, 0.5, -0.5]);
        assert_eq!(project([-1.0, 1.0], 0.5), [0.0, 0.0]);
        let [normal, tangential] = project([1.0, 2.0], 0.5);
        assert!((tangential - 0.5 * normal).abs() < 1e-15 && ((1.0 - normal) + 0.5 * (2.0 - tangential)).abs() < 1e-15);
    }

    #[test]
    fn the_natural_map_is_zero_just_where_a_contact_is_open_sticks_or_slips() {
        for (force, velocity) in [([0.0, 0.0], [0.3, 2.0]), ([1.0, 0.3], [0.0, 0.0]), ([1.0, -0.5], [0.0, 4.0])] {
            assert!(natural_map(&force, &velocity, 0.5, 0.0) < 1e-15, "{force:?} {velocity:?}");
        }
        assert!(natural_map(&[1.0, f64::NAN], &[0.0, 0.0], 0.5, 0.0).is_nan());
        for (force, velocity) in [([0.0, 0.0], [-0.3, 0.0]), ([1.0, 0.3], [0.0, 0.1]), ([1.0, 0.5], [0.0, 4.0]), ([1.0, 0.0], [0.1, 0.0])] {
            assert!(natural_map(&force, &velocity, 0.5, 0.0) > 1e-2, "{force:?} {velocity:?}");
        }
    }

    #[test]
    fn by_the_convex_law_a_contact_that_slips_opens() {
        for (force, velocity, state) in [
            ([0.0, 0.0], [1.1, 2.0], ContactState::Open),
            ([1.0, 0.3], [0.0, 0.0], ContactState::Sticking),
            ([1.0, -0.5], [2.0, 4.0], ContactState::Slipping),
        ] {
            assert!(natural_map(&force, &velocity, 0.5, 0.5) < 1e-15, "{force:?} {velocity:?}");
            assert_eq!(ContactState::by_projection(&[force[0] - velocity[0], force[1] - velocity[1]], 0.5), state);
        }
        assert!(natural_map(&[1.0, -0.5], &[0.0, 4.0], 0.5, 0.5) > 1e-2);
    }
}
