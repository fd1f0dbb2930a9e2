//! What is accepted and what is refused.

use super::*;

/// A root over objects 1 to 5, with object 1 directly on it and two children; object 0 is on no proxy.
fn tables() -> ProxyTables {
    ProxyTables {
        visible: true,
        sphere: vec![[0.0, 0.0, 0.0, 9.0], [-3.0, 0.0, 0.0, 2.0], [3.0, 0.0, 0.0, 0.0]],
        subtree: vec![3, 1, 1],
        first_object: vec![1, 2, 4],
        object_count: vec![5, 2, 2],
        object: Some(vec![5, 4, 3, 2, 1, 0]),
        error: vec![0.5, 0.25, 0.5],
        deviation: None,
        mesh: vec![7, 8, 8],
        origin: vec![[0.0; 3], [-3.0, 0.0, 0.0], [3.0, 0.0, 0.0]],
    }
}

fn refused(change: impl Fn(&mut ProxyTables)) -> TreeError {
    let mut tables = tables();
    change(&mut tables);
    match Proxies::new(tables, 6).unwrap_err() {
        TreeError::Proxies(inner) => *inner,
        other => other,
    }
}

#[test]
fn valid_tables_are_read() {
    let proxies = Proxies::new(tables(), 6).unwrap();
    assert!(proxies.visible_only());
    let depths: Vec<u32> = proxies.nodes().iter().map(|node| node.depth).collect();
    assert_eq!(depths, [0, 1, 1]);
    assert_eq!(proxies.nodes()[1].objects(), 2..4);
    assert_eq!((proxies.object(1), proxies.position(4)), (4, 1));
    assert_eq!(proxies.nodes()[2].origin, Vec3::new(3.0, 0.0, 0.0));
    let same_order = Proxies::new(ProxyTables { object: None, ..tables() }, 6).unwrap();
    assert_eq!((same_order.object(2), same_order.position(2)), (2, 2));
    assert!(Proxies::new(ProxyTables::default(), u32::MAX).unwrap().nodes().is_empty());
}

#[test]
fn errors_do_not_rise_downwards() {
    assert_eq!(refused(|t| t.error[1] = 0.51), TreeError::ProxyError { node: 1 });
    for bad in [-0.1, f32::NAN, f32::INFINITY] {
        assert_eq!(refused(|t| t.error[0] = bad), TreeError::ProxyError { node: 0 });
    }
}

#[test]
fn deviations_are_within_the_errors() {
    let of = |mean, rms, wrong| Deviation { mean, rms, wrong };
    let good = vec![of(0.1, 0.5, 0.0), of(0.0, 0.0, 1.0), of(0.25, 0.25, 0.5)];
    let known = Proxies::new(ProxyTables { deviation: Some(good.clone()), ..tables() }, 6).unwrap();
    assert_eq!(known.nodes()[2].deviation, good[2]);
    assert_eq!(Proxies::new(tables(), 6).unwrap().nodes()[1].deviation, Deviation::of_error(0.25));
    for bad in [of(0.1, 0.3, 0.0), of(0.2, 0.1, 0.0), of(0.0, 0.0, -0.1), of(f32::NAN, 0.1, 0.0)] {
        let change = |t: &mut ProxyTables| t.deviation = Some([&[good[0], bad], &good[2..]].concat());
        assert_eq!(refused(change), TreeError::ProxyDeviation { node: 1 });
    }
    let short = refused(|t| t.deviation = Some(Vec::new()));
    assert_eq!(short, TreeError::TableLength { table: "PROXY_DEVIATION", found: 0, expected: 3 });
}

#[test]
fn broken_tables_are_refused() {
    assert_eq!(refused(|t| t.subtree[1] = 3), TreeError::Subtree { node: 1 });
    assert_eq!(refused(|t| t.object_count[2] = 1), TreeError::ObjectRange { node: 0 });
    assert_eq!(refused(|t| t.object_count[0] = 6), TreeError::ObjectRange { node: 0 });
    assert_eq!(refused(|t| t.sphere[2][3] = -1.0), TreeError::Sphere { node: 2 });
    assert_eq!(refused(|t| t.origin[1][2] = f32::NAN), TreeError::ProxyOrigin { node: 1 });
    let length = |table, found, expected| TreeError::TableLength { table, found, expected };
    assert_eq!(refused(|t| t.mesh.truncate(1)), length("PROXY_MESH", 1, 3));
    assert_eq!(refused(|t| t.error.push(0.0)), length("PROXY_ERROR", 4, 3));
    assert_eq!(refused(|t| t.origin.clear()), length("PROXY_ORIGIN", 0, 3));
    assert_eq!(refused(|t| t.first_object.clear()), length("PROXY_FIRST_OBJECT", 0, 3));
}

#[test]
fn the_order_is_a_permutation_of_all_objects() {
    assert_eq!(refused(|t| t.object = Some(vec![0, 1, 2, 3, 4, 4])), TreeError::ProxyOrder { value: 4 });
    assert_eq!(refused(|t| t.object = Some(vec![0, 1, 2, 3, 4, 6])), TreeError::ProxyOrder { value: 6 });
    let error = refused(|t| t.object = Some(vec![0, 1]));
    assert_eq!(error, TreeError::TableLength { table: "PROXY_OBJECT", found: 2, expected: 6 });
}
