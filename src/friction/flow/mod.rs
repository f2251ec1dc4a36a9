//! Friction between bodies in a fluid: contacts as rows of the coupled system.

pub mod held_contact;
pub mod held_rows;
pub mod in_flow;
pub mod network;
