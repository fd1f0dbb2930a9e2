use super::*;
use proptest::prelude::*;

/// The dissertation's table: name, directions, smallest pairwise angle (degrees).
const TABLE: [(&str, usize, f64); 20] = [
    ("tetrahedron", 4, 109.47),
    ("octahedron", 6, 90.00),
    ("cube", 8, 70.53),
    ("tetrahedron-1", 10, 54.74),
    ("icosahedron", 12, 63.43),
    ("octahedron-1", 18, 45.00),
    ("dodecahedron", 20, 41.81),
    ("tetrahedron-2", 34, 27.37),
    ("icosahedron-1", 42, 31.72),
    ("octahedron-2", 66, 22.50),
    ("tetrahedron-3", 130, 13.68),
    ("icosahedron-2", 162, 15.86),
    ("octahedron-3", 258, 11.25),
    ("tetrahedron-4", 514, 6.84),
    ("icosahedron-3", 642, 7.93),
    ("octahedron-4", 1026, 5.62),
    ("tetrahedron-5", 2050, 3.42),
    ("icosahedron-4", 2562, 3.96),
    ("octahedron-5", 4098, 2.81),
    ("icosahedron-5", 10242, 1.98),
];

fn set(name: &str) -> &'static DirectionSet {
    DirectionSet::by_name(name).unwrap()
}

fn brute_force(set: &DirectionSet, vector: DVec3) -> usize {
    let (p, _) = on_octahedron(vector).unwrap();
    let mut best = 0;
    for i in 1..set.len() {
        if set.direction_f64(i).dot(p) > set.direction_f64(best).dot(p) {
            best = i;
        }
    }
    best
}

#[test]
fn counts_and_angles_equal_the_published_table() {
    for (name, count, angle) in TABLE {
        let set = set(name);
        assert_eq!(set.len(), count, "{name}");
        assert_eq!(set.name(), name);
        // The nearest other direction is a Delaunay neighbour.
        let largest = (0..count)
            .flat_map(|i| set.ring(i).iter().map(move |&j| (i, j as usize)))
            .map(|(i, j)| set.direction_f64(i).dot(set.direction_f64(j)))
            .fold(-1.0, f64::max);
        // The table truncates some figures and rounds others.
        assert!(
            (largest.acos().to_degrees() - angle).abs() < 0.0101,
            "{name} {}",
            largest.acos().to_degrees()
        );
    }
}

#[test]
fn names_are_exactly_the_table() {
    assert_eq!(TABLE.map(|row| row.0), DIRECTION_SETS);
    assert!(DirectionSet::by_name("icosahedron-6").is_none());
    assert!(DirectionSet::by_name("").is_none());
}

#[test]
fn directions_are_unit_and_have_no_negative_zero() {
    for name in DIRECTION_SETS {
        for i in 0..set(name).len() {
            let d = set(name).direction(i);
            assert!((d.length() - 1.0).abs() < 1e-6);
            for c in d.to_array() {
                assert!(c != 0.0 || c.is_sign_positive(), "{name} {i} {d}");
            }
            assert_eq!(set(name).nearest(d), i);
        }
    }
}

#[test]
fn triangulations_are_closed_and_convex() {
    for name in DIRECTION_SETS {
        let set = set(name);
        assert_eq!(set.triangles().len(), 2 * set.len() - 4, "{name}");
        let edges = delaunay::EdgeMap::new(set.triangles());
        let all = set.triangles().iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
        for (a, b) in all {
            let (left, right) = (edges.get((a, b)).unwrap(), edges.get((b, a)).unwrap());
            let [pa, pb, pc] = set.triangles()[left as usize].map(|i| set.direction_f64(i as usize));
            assert!(pa.dot(pb.cross(pc)) > 0.0);
            for d in set.triangles()[right as usize] {
                let above = (pb - pa).cross(pc - pa).dot(set.direction_f64(d as usize) - pa);
                assert!(above < 1e-11, "{name}");
            }
        }
        for i in 0..set.len() {
            for &j in set.ring(i) {
                assert!(set.ring(j as usize).contains(&(i as u16)));
            }
        }
    }
}

#[test]
fn larger_sets_begin_with_the_smaller_ones() {
    for solid in ["tetrahedron", "octahedron", "icosahedron"] {
        for k in 1..5 {
            let (small, large) = (set(&format!("{solid}-{k}")), set(&format!("{solid}-{}", k + 1)));
            assert!((0..small.len()).all(|i| small.direction_f64(i) == large.direction_f64(i)));
        }
    }
}

#[test]
fn nearest_survives_the_edges_of_the_number_range() {
    let values = [0.0f32, -0.0, 1.0, -1.0, f32::MIN_POSITIVE, 1e-45, -1e-45, f32::MAX, f32::MIN, 0.5, 1e-20];
    for name in ["tetrahedron-2", "cube", "dodecahedron", "icosahedron-1", "octahedron-3"] {
        let set = set(name);
        for x in values {
            for y in values {
                for z in values {
                    let v = Vec3::new(x, y, z);
                    if v == Vec3::ZERO {
                        assert_eq!(set.nearest(v), 0);
                    } else {
                        assert_eq!(set.nearest(v), brute_force(set, v.as_dvec3()), "{name} {v}");
                    }
                }
            }
        }
        for bad in [f32::NAN, f32::INFINITY] {
            assert_eq!(set.nearest(Vec3::new(bad, 0.0, 1.0)), 0);
            assert!(set.weights(Vec3::new(0.0, bad, 1.0)).1[0].is_finite());
        }
        for exponent in [-320, -300, 300, 308] {
            let v = DVec3::new(0.3, -0.5, 0.8) * 10f64.powi(exponent);
            assert_eq!(set.nearest_f64(v), brute_force(set, v));
        }
    }
}

/// Vectors all over the sphere, many of them on the planes where cells, triangles and bins meet.
fn vectors() -> impl Strategy<Value = Vec3> {
    let component = prop_oneof![
        4 => -1.0f32..1.0,
        1 => prop_oneof![Just(0.0f32), Just(-0.0), Just(0.5), Just(-0.5), Just(1.0), Just(-1.0), Just(1e-7)],
    ];
    (component.clone(), component.clone(), component)
        .prop_map(|(x, y, z)| Vec3::new(x, y, z))
        .prop_filter("zero", |v| *v != Vec3::ZERO)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn nearest_equals_brute_force(v in vectors(), scale in -30i32..30) {
        let v = v * 2f32.powi(scale);
        for name in DIRECTION_SETS {
            prop_assert_eq!(set(name).nearest(v), brute_force(set(name), v.as_dvec3()), "{}", name);
        }
    }

    #[test]
    fn triangle_holds_the_vector(v in vectors()) {
        for name in DIRECTION_SETS {
            let set = set(name);
            let (triangle, weights) = set.weights(v);
            prop_assert!(weights.iter().all(|w| (0.0..=1.0).contains(w)));
            prop_assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-5);
            let point: DVec3 = (0..3)
                .map(|k| set.direction_f64(triangle[k] as usize) * f64::from(weights[k]))
                .sum();
            prop_assert!(point.normalize().dot(v.as_dvec3().normalize()) > 1.0 - 1e-9, "{} {}", name, v);
        }
    }

    #[test]
    fn bins_hold_what_is_around(v in vectors(), to in vectors(), radius in 0.0..0.5_f64, set_index in 0..14_usize) {
        let set = set(DIRECTION_SETS[set_index]);
        let (v, to) = (v.as_dvec3().normalize_or_zero(), to.as_dvec3().normalize_or_zero());
        if let Some(bin) = set.bin_around(v, radius) {
            prop_assert_eq!(set.nearest_f64(v + to * radius), bin);
            if set.is_acute() {
                prop_assert!(set.weights_f64(v + to * radius).0.contains(&(bin as u16)));
            }
        }
        // The bin's own direction is in its middle.
        let bin = set.nearest_f64(v);
        let nearest = set.ring(bin).iter().map(|&i| {
            set.direction_f64(bin).dot(set.direction_f64(usize::from(i))).acos()
        });
        let half = nearest.fold(f64::MAX, f64::min) * 0.5;
        prop_assert_eq!(set.bin_around(set.direction_f64(bin), half.sin() * 0.999), Some(bin));
        prop_assert_eq!(set.bin_around(set.direction_f64(bin), half.sin() * 1.001), None);
    }

    #[test]
    fn lengths_do_not_matter(v in vectors(), scale in -30i32..30) {
        for name in ["icosahedron-1", "dodecahedron"] {
            prop_assert_eq!(set(name).nearest(v), set(name).nearest(v * 2f32.powi(scale)));
        }
    }
}

#[test]
fn subdivided_tetrahedra_need_flips() {
    let mut mesh = Solid::Tetrahedron.mesh();
    for _ in 0..3 {
        mesh = subdivide::subdivide(&mesh);
    }
    let mut flipped = mesh.triangles.clone();
    delaunay::make_delaunay(&mesh.vertices, &mut flipped);
    let changed = flipped.iter().zip(&mesh.triangles).filter(|(a, b)| a != b).count();
    assert!(changed > 0);
}

/// Those a bake uses are; the cube's squares are cut into right triangles.
#[test]
fn most_sets_are_acute() {
    for name in ["dodecahedron", "icosahedron-1", "icosahedron-2", "icosahedron-3", "octahedron-1"] {
        println!("{name}: {}", set(name).is_acute());
    }
    assert!(set("icosahedron-1").is_acute() && set("icosahedron-2").is_acute());
    assert!(!set("cube").is_acute());
}
