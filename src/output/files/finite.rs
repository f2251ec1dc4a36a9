//! The guard where results leave: no number that is told is NaN or infinite.

use serde::{
    Serialize, Serializer,
    ser::{
        SerializeMap, SerializeSeq, SerializeStruct, SerializeStructVariant, SerializeTuple, SerializeTupleStruct, SerializeTupleVariant,
    },
};

use crate::error::{Error, Result};

/// Refuses to tell results of which a number is not finite.
///
/// # Errors
/// [`Error::Diverged`], naming the first such number.
pub fn check_finite(what: &str, results: &impl Serialize) -> Result<()> {
    let mut walk = Walk { path: Vec::new(), found: None };
    results.serialize(&mut walk).expect("a walk writes nothing that could fail");
    walk.found.map_or(Ok(()), |(path, value)| Err(not_finite(what, &path, value)))
}

/// The error of a number that is not finite.
pub fn not_finite(what: &str, name: &str, value: f64) -> Error {
    Error::Diverged(format!(
        "{what} is not written: {name} is {value}; a number of the scene is too large or too small for the others, or time.step too long: \
         choose other units or a smaller step"
    ))
}

/// A walk through numbers and where it is.
struct Walk {
    path: Vec<String>,
    found: Option<(String, f64)>,
}

type Serialized = std::result::Result<(), serde_json::Error>;

impl Walk {
    fn step(&mut self, name: String, value: &(impl Serialize + ?Sized)) -> Serialized {
        self.path.push(name);
        let outcome = value.serialize(&mut *self);
        self.path.pop();
        outcome
    }
}

/// Fields and elements on the way, numbered where they have no name.
struct Fields<'a> {
    walk: &'a mut Walk,
    passed: usize,
    /// The name of the next entry of a map.
    key: Option<String>,
}

impl<'a> Fields<'a> {
    fn of(walk: &'a mut Walk) -> Fields<'a> {
        Fields { walk, passed: 0, key: None }
    }

    fn next(&mut self, value: &(impl Serialize + ?Sized)) -> Serialized {
        self.passed += 1;
        let name = self.key.take().unwrap_or_else(|| (self.passed - 1).to_string());
        self.walk.step(name, value)
    }
}

macro_rules! plain {
    ($($name:ident: $kind:ty),*) => { $(fn $name(self, _: $kind) -> Serialized { Ok(()) })* };
}

macro_rules! numbered {
    ($($part:ident: $name:ident),*) => { $(impl $part for Fields<'_> {
        type Ok = ();
        type Error = serde_json::Error;
        fn $name<T: Serialize + ?Sized>(&mut self, value: &T) -> Serialized { self.next(value) }
        fn end(self) -> Serialized { Ok(()) }
    })* };
}

macro_rules! named {
    ($($part:ident),*) => { $(impl $part for Fields<'_> {
        type Ok = ();
        type Error = serde_json::Error;
        fn serialize_field<T: Serialize + ?Sized>(&mut self, name: &'static str, value: &T) -> Serialized { self.walk.step(name.into(), value) }
        fn end(self) -> Serialized { Ok(()) }
    })* };
}

numbered!(SerializeSeq: serialize_element, SerializeTuple: serialize_element);
numbered!(SerializeTupleStruct: serialize_field, SerializeTupleVariant: serialize_field);
named!(SerializeStruct, SerializeStructVariant);

impl SerializeMap for Fields<'_> {
    type Ok = ();
    type Error = serde_json::Error;

    fn serialize_key<T: Serialize + ?Sized>(&mut self, key: &T) -> Serialized {
        self.key = serde_json::to_value(key)?.as_str().map(str::to_owned);
        Ok(())
    }

    fn serialize_value<T: Serialize + ?Sized>(&mut self, value: &T) -> Serialized {
        self.next(value)
    }

    fn end(self) -> Serialized {
        Ok(())
    }
}

type Begun<'a> = std::result::Result<Fields<'a>, serde_json::Error>;

impl<'a> Serializer for &'a mut Walk {
    type Ok = ();
    type Error = serde_json::Error;
    type SerializeSeq = Fields<'a>;
    type SerializeTuple = Fields<'a>;
    type SerializeTupleStruct = Fields<'a>;
    type SerializeTupleVariant = Fields<'a>;
    type SerializeMap = Fields<'a>;
    type SerializeStruct = Fields<'a>;
    type SerializeStructVariant = Fields<'a>;

    plain!(serialize_bool: bool, serialize_i8: i8, serialize_i16: i16, serialize_i32: i32, serialize_i64: i64, serialize_u8: u8);
    plain!(serialize_u16: u16, serialize_u32: u32, serialize_u64: u64, serialize_char: char, serialize_str: &str, serialize_bytes: &[u8]);

    fn serialize_f32(self, value: f32) -> Serialized {
        self.serialize_f64(value.into())
    }

    fn serialize_f64(self, value: f64) -> Serialized {
        if !value.is_finite() && self.found.is_none() {
            self.found = Some((self.path.join("."), value));
        }
        Ok(())
    }

    fn serialize_none(self) -> Serialized {
        Ok(())
    }

    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Serialized {
        value.serialize(self)
    }

    fn serialize_unit(self) -> Serialized {
        Ok(())
    }

    fn serialize_unit_struct(self, _: &'static str) -> Serialized {
        Ok(())
    }

    fn serialize_unit_variant(self, _: &'static str, _: u32, _: &'static str) -> Serialized {
        Ok(())
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(self, _: &'static str, value: &T) -> Serialized {
        value.serialize(self)
    }

    fn serialize_newtype_variant<T: Serialize + ?Sized>(self, _: &'static str, _: u32, name: &'static str, value: &T) -> Serialized {
        self.step(name.into(), value)
    }

    fn serialize_seq(self, _: Option<usize>) -> Begun<'a> {
        Ok(Fields::of(self))
    }

    fn serialize_tuple(self, _: usize) -> Begun<'a> {
        Ok(Fields::of(self))
    }

    fn serialize_tuple_struct(self, _: &'static str, _: usize) -> Begun<'a> {
        Ok(Fields::of(self))
    }

    fn serialize_tuple_variant(self, _: &'static str, _: u32, _: &'static str, _: usize) -> Begun<'a> {
        Ok(Fields::of(self))
    }

    fn serialize_map(self, _: Option<usize>) -> Begun<'a> {
        Ok(Fields::of(self))
    }

    fn serialize_struct(self, _: &'static str, _: usize) -> Begun<'a> {
        Ok(Fields::of(self))
    }

    fn serialize_struct_variant(self, _: &'static str, _: u32, _: &'static str, _: usize) -> Begun<'a> {
        Ok(Fields::of(self))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    #[derive(Serialize)]
    struct Inner {
        velocity: Vec<f64>,
        #[serde(flatten)]
        others: BTreeMap<String, Option<f64>>,
    }

    #[derive(Serialize)]
    struct Outer {
        steps: usize,
        bodies: Vec<Inner>,
    }

    #[test]
    fn numbers_that_are_none_are_named_and_absent_ones_are_not() {
        let results =
            |value, gap| Outer { steps: 3, bodies: vec![Inner { velocity: vec![1.0, value], others: [("gap".into(), gap)].into() }] };
        check_finite("summary.json", &results(2.0, None)).unwrap();
        let error = |results| check_finite("summary.json", &results).unwrap_err().to_string();
        assert!(error(results(f64::NAN, None)).starts_with("summary.json is not written: bodies.0.velocity.1 is NaN; "));
        assert!(error(results(0.0, Some(f64::INFINITY))).contains("bodies.0.gap is inf"));
    }
}
