//! Reading the elements of accessors (glTF 2.0, section 3.6.2; normalized integers as in section 3.11).

use super::accessor::Accessor;
use super::error::AccessorError;
use super::kinds::{AccessorKind, ComponentType};
use glam::{DVec3, DVec4, Vec2, Vec4};
use std::borrow::Cow;

impl<'a> Accessor<'a> {
    /// Elements of a `VEC3` accessor, of any component type (`KHR_mesh_quantization`). Floats come as they are, NaN
    /// and infinities included.
    ///
    /// # Errors
    /// [`AccessorError::WrongKind`] if the accessor is not `VEC3`.
    pub fn read_vec3_f64(&self) -> Result<Vec<DVec3>, AccessorError> {
        self.require(AccessorKind::Vec3, "VEC3")?;
        Ok(self.decode(DVec3::from_array))
    }

    /// Elements of a `VEC4` accessor, of any component type.
    ///
    /// # Errors
    /// [`AccessorError::WrongKind`] if the accessor is not `VEC4`.
    pub fn read_vec4_f64(&self) -> Result<Vec<DVec4>, AccessorError> {
        self.require(AccessorKind::Vec4, "VEC4")?;
        Ok(self.decode(DVec4::from_array))
    }

    /// Elements of a `VEC2` accessor, of any component type.
    ///
    /// # Errors
    /// [`AccessorError::WrongKind`] if the accessor is not `VEC2`.
    pub fn read_vec2_f32(&self) -> Result<Vec<Vec2>, AccessorError> {
        self.require(AccessorKind::Vec2, "VEC2")?;
        Ok(self.decode(|[x, y]: [f64; 2]| Vec2::new(x as f32, y as f32)))
    }

    /// Elements of a `VEC4` accessor, of any component type.
    ///
    /// # Errors
    /// [`AccessorError::WrongKind`] if the accessor is not `VEC4`.
    pub fn read_vec4_f32(&self) -> Result<Vec<Vec4>, AccessorError> {
        self.require(AccessorKind::Vec4, "VEC4")?;
        Ok(self.decode(|element| DVec4::from_array(element).as_vec4()))
    }

    /// Elements of a `SCALAR` accessor, of any component type.
    ///
    /// # Errors
    /// [`AccessorError::WrongKind`] if the accessor is not `SCALAR`.
    pub fn read_scalars_f64(&self) -> Result<Vec<f64>, AccessorError> {
        self.require(AccessorKind::Scalar, "SCALAR")?;
        Ok(self.decode(|[value]: [f64; 1]| value))
    }

    /// Elements of a `SCALAR` accessor of unsigned integers: vertex indices.
    ///
    /// # Errors
    /// [`AccessorError::WrongKind`] if the accessor is anything else.
    pub fn read_indices_u32(&self) -> Result<Vec<u32>, AccessorError> {
        let expected = "SCALAR of unsigned integers";
        self.require(AccessorKind::Scalar, expected)?;
        let mut out = match self.component_type {
            ComponentType::U8 => self.base(|[byte]: [u8; 1]| u32::from(byte)),
            ComponentType::U16 => self.base(|bytes| u32::from(u16::from_le_bytes(bytes))),
            ComponentType::U32 => self.base(u32::from_le_bytes),
            _ => return Err(self.wrong_kind(expected)),
        };
        self.substitute(&mut out, |bytes| {
            bytes.iter().rev().fold(0, |word, &byte| word << 8 | u32::from(byte))
        });
        Ok(out)
    }

    /// The elements as stored, little-endian, one after the other without gaps; borrowed from the file if they lie
    /// there like that. `None` for matrices with padded columns.
    pub fn bytes(&self) -> Option<Cow<'a, [u8]>> {
        let element = self.kind.element_size(self.component_type);
        if element != self.kind.components() * self.component_type.size() {
            return None;
        }
        let mut packed: Cow<'a, [u8]> = match self.base {
            None => Cow::Owned(vec![0; self.count * element]),
            Some(base) if base.stride == element => Cow::Borrowed(&base.bytes[..self.count * element]),
            Some(base) => {
                let strides = base.bytes.chunks(base.stride).take(self.count);
                Cow::Owned(strides.flat_map(|stride| &stride[..element]).copied().collect())
            }
        };
        if let Some(sparse) = &self.sparse {
            let packed = packed.to_mut();
            for (&index, value) in sparse.indices.iter().zip(sparse.values.chunks_exact(element)) {
                packed[index * element..][..element].copy_from_slice(value);
            }
        }
        Some(packed)
    }

    fn require(&self, kind: AccessorKind, expected: &'static str) -> Result<(), AccessorError> {
        if self.kind == kind { Ok(()) } else { Err(self.wrong_kind(expected)) }
    }

    fn wrong_kind(&self, expected: &'static str) -> AccessorError {
        let found = format!("{} of component type {}", self.kind.name(), self.component_type.code());
        AccessorError::WrongKind { pointer: self.pointer(), found, expected }
    }

    /// Elements of `N` components in one column, as numbers, through `make`.
    fn decode<const N: usize, T: Copy>(&self, make: impl Fn([f64; N]) -> T) -> Vec<T> {
        // Signed fractions are clamped: -128 and -127 both stand for -1.
        let normalized = self.normalized;
        let unsigned = move |value: f64, max: f64| if normalized { value / max } else { value };
        let signed = move |value: f64, max: f64| if normalized { (value / max).max(-1.0) } else { value };
        match self.component_type {
            ComponentType::I8 => self.decode_as(|[b]: [u8; 1]| signed(f64::from(b as i8), 127.0), make),
            ComponentType::U8 => self.decode_as(|[b]: [u8; 1]| unsigned(f64::from(b), 255.0), make),
            ComponentType::I16 => {
                self.decode_as(|b| signed(f64::from(i16::from_le_bytes(b)), 32_767.0), make)
            }
            ComponentType::U16 => {
                self.decode_as(|b| unsigned(f64::from(u16::from_le_bytes(b)), 65_535.0), make)
            }
            ComponentType::U32 => {
                self.decode_as(|b| unsigned(f64::from(u32::from_le_bytes(b)), f64::from(u32::MAX)), make)
            }
            ComponentType::F32 => self.decode_as(|b| f64::from(f32::from_le_bytes(b)), make),
        }
    }

    fn decode_as<const N: usize, const S: usize, T: Copy>(
        &self,
        number: impl Fn([u8; S]) -> f64,
        make: impl Fn([f64; N]) -> T,
    ) -> Vec<T> {
        let element = |bytes: &[u8]| {
            let mut components = [0.0; N];
            for (component, bytes) in components.iter_mut().zip(bytes.as_chunks::<S>().0) {
                *component = number(*bytes);
            }
            make(components)
        };
        let mut out = match self.base {
            None => vec![make([0.0; N]); self.count],
            Some(base) => base.bytes.chunks(base.stride).take(self.count).map(element).collect(),
        };
        self.substitute(&mut out, element);
        out
    }

    /// The elements below the sparse ones, for scalars of `S` bytes.
    fn base<const S: usize>(&self, number: impl Fn([u8; S]) -> u32) -> Vec<u32> {
        match self.base {
            None => vec![0; self.count],
            // `accessor()` has checked that even the last, possibly shorter, stride holds an element.
            Some(base) => {
                let strides = base.bytes.chunks(base.stride).take(self.count);
                strides.filter_map(|stride| stride.first_chunk().map(|bytes| number(*bytes))).collect()
            }
        }
    }

    fn substitute<T>(&self, out: &mut [T], element: impl Fn(&[u8]) -> T) {
        let Some(sparse) = &self.sparse else { return };
        let size = self.kind.element_size(self.component_type);
        for (&index, bytes) in sparse.indices.iter().zip(sparse.values.chunks_exact(size)) {
            out[index] = element(bytes);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Document;
    use super::*;
    use serde_json::{Value, json};

    /// A document with one buffer, the given views (offset, length, stride) and one accessor.
    fn document(bytes: Vec<u8>, views: &[(usize, usize, Option<usize>)], accessor: Value) -> Document {
        let view = |&(offset, length, stride): &(usize, usize, Option<usize>)| {
            let mut view = json!({"buffer": 0, "byteOffset": offset, "byteLength": length});
            if let Some(stride) = stride {
                view["byteStride"] = json!(stride);
            }
            view
        };
        let views: Vec<Value> = views.iter().map(view).collect();
        let json = json!({"asset": {"version": "2.0"}, "buffers": [{"byteLength": bytes.len()}],
            "bufferViews": views, "accessors": [accessor]});
        Document::from_parts(json, Some(bytes)).unwrap()
    }

    #[test]
    fn floats_with_stride_and_offset() {
        let mut bytes = vec![0xAA; 4];
        for value in [1.0_f32, 2.0, 3.0, 99.0, 4.0, 5.0, 6.0] {
            bytes.extend(value.to_le_bytes());
        }
        let accessor = json!({"bufferView": 0, "byteOffset": 4, "componentType": 5126, "count": 2, "type": "VEC3",
            "min": [1, 2, 3], "max": [4.0, 5, 6]});
        // The last element has no full stride left.
        let document = document(bytes, &[(0, 32, Some(16))], accessor);
        let accessor = document.accessor(0).unwrap();
        let positions = accessor.read_vec3_f64().unwrap();
        assert_eq!(positions, [DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, 5.0, 6.0)]);
        assert_eq!(accessor.min_max(), Some((vec![1.0, 2.0, 3.0], vec![4.0, 5.0, 6.0])));
        assert_eq!(accessor.bytes().unwrap().len(), 24);
        assert!(matches!(accessor.read_vec2_f32(), Err(AccessorError::WrongKind { .. })));
        assert!(matches!(accessor.read_indices_u32(), Err(AccessorError::WrongKind { .. })));
    }

    #[test]
    fn every_component_type_plain_and_normalized() {
        let cases: [(u32, &[u8], f64, f64); 8] = [
            (5120, &[0x80], -128.0, -1.0),
            (5120, &[0x7F], 127.0, 1.0),
            (5121, &[255], 255.0, 1.0),
            (5122, &[0, 0x80], -32_768.0, -1.0),
            (5122, &[0xFF, 0x7F], 32_767.0, 1.0),
            (5123, &[0xFF, 0xFF], 65_535.0, 1.0),
            (5125, &[0xFF; 4], 4_294_967_295.0, 1.0),
            (5126, &[0, 0, 0x80, 0x3F], 1.0, 1.0),
        ];
        for (code, bytes, plain, fraction) in cases {
            for (normalized, expected) in [(false, plain), (true, fraction)] {
                let accessor = json!({"bufferView": 0, "componentType": code, "count": 1, "type": "SCALAR",
                    "normalized": normalized});
                let document = document(bytes.to_vec(), &[(0, bytes.len(), None)], accessor);
                assert_eq!(document.accessor(0).unwrap().read_scalars_f64().unwrap(), [expected], "{code}");
            }
        }
    }

    #[test]
    fn indices_of_every_width() {
        for (code, bytes) in
            [(5121, vec![1, 2]), (5123, vec![1, 0, 2, 0]), (5125, vec![1, 0, 0, 0, 2, 0, 0, 0])]
        {
            let length = bytes.len();
            let accessor = json!({"bufferView": 0, "componentType": code, "count": 2, "type": "SCALAR"});
            let document = document(bytes, &[(0, length, None)], accessor);
            assert_eq!(document.accessor(0).unwrap().read_indices_u32().unwrap(), [1, 2]);
        }
    }

    #[test]
    fn sparse_elements_replace_zeros_and_stored_ones() {
        // Indices 2 and 0, then the values 30 and 10, then three stored bytes.
        let bytes = vec![2, 0, 30, 10, 7, 8, 9];
        let views = [(0, 2, None), (2, 2, None), (4, 3, None)];
        let sparse = json!({"count": 2, "indices": {"bufferView": 0, "componentType": 5121},
            "values": {"bufferView": 1}});
        let zeros = json!({"componentType": 5121, "count": 3, "type": "SCALAR", "sparse": sparse});
        let zeros = document(bytes.clone(), &views, zeros);
        assert_eq!(zeros.accessor(0).unwrap().read_indices_u32().unwrap(), [10, 0, 30]);
        let stored =
            json!({"bufferView": 2, "componentType": 5121, "count": 3, "type": "SCALAR", "sparse": sparse});
        let stored = document(bytes.clone(), &views, stored);
        let accessor = stored.accessor(0).unwrap();
        assert_eq!(accessor.read_indices_u32().unwrap(), [10, 8, 30]);
        assert_eq!(accessor.read_scalars_f64().unwrap(), [10.0, 8.0, 30.0]);
        assert_eq!(&*accessor.bytes().unwrap(), [10, 8, 30]);
        let beyond = json!({"componentType": 5121, "count": 2, "type": "SCALAR", "sparse": sparse});
        assert!(document(bytes, &views, beyond).accessor(0).is_err());
    }

    #[test]
    fn packed_data_is_borrowed_and_padded_matrices_are_not_bytes() {
        let accessor = json!({"bufferView": 0, "componentType": 5121, "count": 2, "type": "VEC4"});
        let packed = document(vec![1; 8], &[(0, 8, None)], accessor);
        assert!(matches!(packed.accessor(0).unwrap().bytes(), Some(Cow::Borrowed(_))));
        let accessor = json!({"bufferView": 0, "componentType": 5121, "count": 1, "type": "MAT3"});
        let matrix = document(vec![1; 12], &[(0, 12, None)], accessor);
        assert_eq!(matrix.accessor(0).unwrap().bytes(), None);
    }

    #[test]
    fn accessors_that_do_not_fit_are_refused() {
        let good = json!({"bufferView": 0, "componentType": 5126, "count": 1, "type": "VEC3"});
        let mut cases = vec![];
        for (key, value) in [
            ("count", json!(2)),
            ("count", json!(u64::MAX)),
            ("count", json!(-1)),
            ("count", json!(null)),
            ("byteOffset", json!(1)),
            ("byteOffset", json!(u64::MAX)),
            ("componentType", json!(5124)),
            ("type", json!("VEC9")),
            ("normalized", json!(3)),
            ("bufferView", json!(1)),
            ("sparse", json!({})),
            (
                "sparse",
                json!({"count": u64::MAX, "indices": {"bufferView": 0, "componentType": 5125},
                "values": {"bufferView": 0}}),
            ),
            (
                "sparse",
                json!({"count": 1, "indices": {"bufferView": 0, "componentType": 5126},
                "values": {"bufferView": 0}}),
            ),
        ] {
            let mut accessor = good.clone();
            accessor[key] = value;
            cases.push(accessor);
        }
        assert!(document(vec![0; 12], &[(0, 12, None)], good.clone()).accessor(0).is_ok());
        for accessor in cases {
            assert!(
                document(vec![0; 12], &[(0, 12, None)], accessor.clone()).accessor(0).is_err(),
                "{accessor}"
            );
        }
        assert!(
            document(vec![0; 12], &[(0, 12, Some(8))], good.clone()).accessor(0).is_err(),
            "small stride"
        );
        assert!(
            document(vec![0; 12], &[(0, 12, Some(0))], good).accessor(0).is_ok(),
            "stride 0 is no stride"
        );
    }

    #[test]
    fn zeros_are_bounded_by_the_file() {
        let zeros = |count: u64| {
            let accessor = json!({"componentType": 5126, "count": count, "type": "VEC3"});
            document(vec![0; 4], &[], accessor)
        };
        assert_eq!(zeros(3).accessor(0).unwrap().read_vec3_f64().unwrap(), [DVec3::ZERO; 3]);
        assert_eq!(zeros(3).accessor(0).unwrap().bytes().unwrap().len(), 36);
        assert!(matches!(zeros(1 << 40).accessor(0), Err(AccessorError::TooManyZeros { .. })));
    }

    #[test]
    fn an_empty_accessor_is_empty() {
        let accessor = json!({"bufferView": 0, "componentType": 5126, "count": 0, "type": "VEC3"});
        let document = document(vec![0; 4], &[(0, 4, None)], accessor);
        assert!(document.accessor(0).unwrap().read_vec3_f64().unwrap().is_empty());
    }
}
