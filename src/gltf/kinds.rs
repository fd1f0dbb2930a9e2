//! Component types and element kinds of accessors (glTF 2.0, sections 3.6.2.2 and 3.6.2.4).

/// Type of one component, little-endian.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ComponentType {
    /// 5120, signed byte.
    I8,
    /// 5121, unsigned byte.
    U8,
    /// 5122, signed short.
    I16,
    /// 5123, unsigned short.
    U16,
    /// 5125, unsigned int.
    U32,
    /// 5126, IEEE single.
    F32,
}

impl ComponentType {
    /// The type a glTF `componentType` stands for.
    pub fn from_code(code: usize) -> Option<ComponentType> {
        Some(match code {
            5120 => ComponentType::I8,
            5121 => ComponentType::U8,
            5122 => ComponentType::I16,
            5123 => ComponentType::U16,
            5125 => ComponentType::U32,
            5126 => ComponentType::F32,
            _ => return None,
        })
    }

    /// The glTF `componentType`.
    pub fn code(self) -> u32 {
        match self {
            ComponentType::I8 => 5120,
            ComponentType::U8 => 5121,
            ComponentType::I16 => 5122,
            ComponentType::U16 => 5123,
            ComponentType::U32 => 5125,
            ComponentType::F32 => 5126,
        }
    }

    /// Bytes of one component.
    pub fn size(self) -> usize {
        match self {
            ComponentType::I8 | ComponentType::U8 => 1,
            ComponentType::I16 | ComponentType::U16 => 2,
            ComponentType::U32 | ComponentType::F32 => 4,
        }
    }
}

/// Shape of one element.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AccessorKind {
    /// One number.
    Scalar,
    /// Two numbers.
    Vec2,
    /// Three numbers.
    Vec3,
    /// Four numbers.
    Vec4,
    /// Two columns of two.
    Mat2,
    /// Three columns of three.
    Mat3,
    /// Four columns of four.
    Mat4,
}

impl AccessorKind {
    /// The kind a glTF accessor `type` stands for.
    pub fn from_name(name: &str) -> Option<AccessorKind> {
        Some(match name {
            "SCALAR" => AccessorKind::Scalar,
            "VEC2" => AccessorKind::Vec2,
            "VEC3" => AccessorKind::Vec3,
            "VEC4" => AccessorKind::Vec4,
            "MAT2" => AccessorKind::Mat2,
            "MAT3" => AccessorKind::Mat3,
            "MAT4" => AccessorKind::Mat4,
            _ => return None,
        })
    }

    /// The glTF accessor `type`.
    pub fn name(self) -> &'static str {
        match self {
            AccessorKind::Scalar => "SCALAR",
            AccessorKind::Vec2 => "VEC2",
            AccessorKind::Vec3 => "VEC3",
            AccessorKind::Vec4 => "VEC4",
            AccessorKind::Mat2 => "MAT2",
            AccessorKind::Mat3 => "MAT3",
            AccessorKind::Mat4 => "MAT4",
        }
    }

    /// Columns, and components per column. Vectors are one column.
    pub fn shape(self) -> (usize, usize) {
        match self {
            AccessorKind::Scalar => (1, 1),
            AccessorKind::Vec2 => (1, 2),
            AccessorKind::Vec3 => (1, 3),
            AccessorKind::Vec4 => (1, 4),
            AccessorKind::Mat2 => (2, 2),
            AccessorKind::Mat3 => (3, 3),
            AccessorKind::Mat4 => (4, 4),
        }
    }

    /// Components of one element.
    pub fn components(self) -> usize {
        let (columns, rows) = self.shape();
        columns * rows
    }

    /// Bytes from one column to the next: matrix columns start on multiples of 4.
    pub(super) fn column_stride(self, component: ComponentType) -> usize {
        let (columns, rows) = self.shape();
        let bytes = rows * component.size();
        if columns > 1 { bytes.next_multiple_of(4) } else { bytes }
    }

    /// Bytes of one element. Of a matrix the padding after the last column counts too.
    pub fn element_size(self, component: ComponentType) -> usize {
        self.shape().0 * self.column_stride(component)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_and_names_go_both_ways() {
        for code in 5118..5130 {
            if let Some(component) = ComponentType::from_code(code) {
                assert_eq!(component.code() as usize, code);
            }
        }
        for name in ["SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"] {
            assert_eq!(AccessorKind::from_name(name).unwrap().name(), name);
        }
        assert_eq!(AccessorKind::from_name("VEC5"), None);
    }

    #[test]
    fn matrix_columns_are_padded() {
        assert_eq!(AccessorKind::Mat2.element_size(ComponentType::U8), 8);
        assert_eq!(AccessorKind::Mat3.element_size(ComponentType::I8), 12);
        assert_eq!(AccessorKind::Mat3.element_size(ComponentType::U16), 24);
        assert_eq!(AccessorKind::Mat3.element_size(ComponentType::F32), 36);
        assert_eq!(AccessorKind::Vec3.element_size(ComponentType::U8), 3);
    }
}
