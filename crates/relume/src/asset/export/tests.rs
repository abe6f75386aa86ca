use std::io::{Cursor, Read};
use std::process::Command;

use npyz::NpyFile;

use super::super::{Precision, samples};
use super::*;

fn entry(bytes: &[u8], name: &str) -> Vec<u8> {
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).unwrap();
    let mut content = Vec::new();
    let mut file = archive.by_name(&format!("{name}.npy")).unwrap();
    file.read_to_end(&mut content).unwrap();
    content
}

/// The shape and the values of an array, in C order.
fn array<T: npyz::Deserialize>(bytes: &[u8], name: &str) -> (Vec<u64>, Vec<T>) {
    let content = entry(bytes, name);
    let npy = NpyFile::new(&content[..]).unwrap();
    assert_eq!(npy.order(), npyz::Order::C);
    (npy.shape().to_vec(), npy.into_vec().unwrap())
}

fn exported() -> (Asset, World, Vec<u8>) {
    let asset = samples::asset();
    let world = World::new(&asset.scene);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("transfer.npz");
    export_transfer(&asset, &world, &path).unwrap();
    let first = std::fs::read(&path).unwrap();
    export_transfer(&asset, &world, &path).unwrap();
    assert_eq!(
        std::fs::read(&path).unwrap(),
        first,
        "the same bytes each time"
    );
    (asset, world, first)
}

/// The order that the format promises, written down naively.
fn expected_rows(world: &World) -> Vec<usize> {
    let mut rows = Vec::new();
    for wanted in [true, false] {
        for (i, &input) in world.from_input.iter().enumerate() {
            if input == wanted {
                rows.push(i);
            }
        }
    }
    rows
}

#[test]
fn every_array_holds_what_the_format_says() {
    let (asset, world, bytes) = exported();
    let transfer = &asset.transfer;
    let rows = expected_rows(&world);
    let vertices = rows.len() as u64;
    assert_eq!(array::<f32>(&bytes, "position").0, [vertices, 3]);
    let vectors = array::<f32>(&bytes, "transfer");
    assert_eq!(vectors.0, [vertices, 3, 9]);
    let (positions, normals) = (
        array::<f32>(&bytes, "position").1,
        array::<f32>(&bytes, "normal").1,
    );
    let (albedos, valid) = (
        array::<f32>(&bytes, "albedo").1,
        array::<bool>(&bytes, "valid").1,
    );
    let sources = array::<i32>(&bytes, "source_vertex").1;
    let expected_albedos = world.vertex_albedos();
    let inputs = world.from_input.iter().filter(|&&input| input).count();
    for (row, &i) in rows.iter().enumerate() {
        assert_eq!(positions[3 * row..][..3], world.positions[i].to_array());
        assert_eq!(normals[3 * row..][..3], world.normals[i].to_array());
        assert_eq!(albedos[3 * row..][..3], expected_albedos[i].to_array());
        assert_eq!(vectors.1[27 * row..][..9], *transfer.vector(i, 0));
        assert_eq!(vectors.1[27 * row + 18..][..9], *transfer.vector(i, 2));
        assert_eq!(valid[row], transfer.valid[i]);
        assert_eq!(sources[row], if row < inputs { row as i32 } else { -1 });
    }
    let back = transfer.back.as_ref().unwrap();
    let backs = array::<i32>(&bytes, "back_vertex").1;
    let vertices: Vec<u32> = backs.iter().map(|&row| rows[row as usize] as u32).collect();
    assert_eq!(vertices, back.vertices);
    assert_eq!(array::<f32>(&bytes, "back_transfer").1, *back.coefficients);
}

#[test]
fn the_header_stands_in_arrays_without_dimension() {
    let (asset, _, bytes) = exported();
    let text = |name: &str| array::<String>(&bytes, name);
    for (key, token) in header::tokens(Precision::F32) {
        assert_eq!(text(key), (vec![], vec![token.to_owned()]));
    }
    assert_eq!(text("kind").1, ["shadowed"]);
    assert_eq!(text("source").1, [asset.scene.source_hash]);
    assert_eq!(array::<i32>(&bytes, "order"), (vec![], vec![3]));
    assert_eq!(array::<i64>(&bytes, "bounces").1, [2]);
    assert_eq!(array::<i64>(&bytes, "samples").1, [1024]);
    assert_eq!(array::<u64>(&bytes, "seed").1, [u64::MAX - 5]);
}

#[test]
fn compound_matrices_keep_to_the_same_rows() {
    let asset = samples::asset();
    let world = World::new(&asset.scene);
    let vertices = asset.transfer.vertex_count();
    let backs = asset.transfer.back.as_ref().unwrap().vertices.len();
    // Outgoing order 2, light of order 3.
    let stride = 3 * 4 * 9;
    let compound = Matrices {
        order: crate::basis::Order::new(2).unwrap(),
        coefficients: samples::numbers(5, vertices * stride).into(),
        back: samples::numbers(6, backs * stride).into(),
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("compound.npz");
    export_compound(&asset, &world, &compound, &path).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let rows = expected_rows(&world);
    let expected: Vec<f32> = rows
        .iter()
        .flat_map(|&i| {
            compound.coefficients[i * stride..][..stride]
                .iter()
                .copied()
        })
        .collect();
    let shape = vec![vertices as u64, 3, 4, 9];
    assert_eq!(array::<f32>(&bytes, "compound"), (shape, expected));
    let back = array::<f32>(&bytes, "back_compound");
    assert_eq!(back, (vec![backs as u64, 3, 4, 9], compound.back.to_vec()));
    assert_eq!(array::<i32>(&bytes, "back_vertex").1.len(), backs);
    assert_eq!(array::<String>(&bytes, "quantity").1, ["radiance"]);
    assert_eq!(array::<i32>(&bytes, "outgoing_order").1, [2]);
    assert_eq!(array::<i32>(&bytes, "order").1, [3]);
}

#[test]
fn half_floats_are_exported_as_floats_that_say_so() {
    let mut asset = samples::asset();
    asset.transfer = asset.transfer.to_precision(Precision::F16).unwrap();
    let world = World::new(&asset.scene);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("transfer.npz");
    export_transfer(&asset, &world, &path).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    assert_eq!(array::<String>(&bytes, "precision").1, ["f16"]);
    let back = asset.transfer.back.unwrap();
    assert_eq!(array::<f32>(&bytes, "back_transfer").1, *back.coefficients);
}

#[test]
fn radiance_keeps_to_the_same_rows() {
    let asset = samples::asset();
    let world = World::new(&asset.scene);
    let values = samples::numbers(9, 3 * world.positions.len());
    let radiance: Vec<[f32; 3]> = values.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("radiance.npz");
    export_radiance(&world, &asset.transfer.valid, &radiance, &path).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let rows = expected_rows(&world);
    let expected: Vec<f32> = rows.iter().flat_map(|&i| radiance[i]).collect();
    assert_eq!(
        array::<f32>(&bytes, "radiance"),
        (vec![rows.len() as u64, 3], expected)
    );
    let short = export_radiance(&world, &asset.transfer.valid, &radiance[1..], &path);
    assert!(
        short
            .unwrap_err()
            .to_string()
            .contains("radiance values for")
    );
}

/// numpy itself reads the file, without pickle, as the README tells people to.
#[test]
fn numpy_reads_the_export() {
    let runs = |code: &str, path: &str| Command::new("python3").args(["-c", code, path]).output();
    if !runs("import numpy", "").is_ok_and(|output| output.status.success()) {
        println!("skipped: numpy_reads_the_export: needs python3 with numpy");
        return;
    }
    let (asset, _, bytes) = exported();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("transfer.npz");
    std::fs::write(&path, bytes).unwrap();
    let code = "import numpy, sys
f = numpy.load(sys.argv[1], allow_pickle=False)
v = len(f['position'])
assert all(f[k].shape == (v, 3) and f[k].dtype == 'float32' for k in ('position', 'normal', 'albedo'))
assert f['transfer'].shape == (v, 3, 9) and f['transfer'].dtype == 'float32'
assert f['source_vertex'].dtype == 'int32' and f['valid'].dtype == bool
assert str(f['basis']) == 'sh' and str(f['convention']) == 'real-no-cs' and int(f['order']) == 3
assert int(f['seed']) == 2**64 - 6 and f['order'].shape == ()
print(f['transfer'].astype('float64').sum(), v)";
    let output = runs(code, &path.to_string_lossy()).unwrap();
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{errors}");
    let text = String::from_utf8(output.stdout).unwrap();
    let (sum, count) = text.trim().split_once(' ').unwrap();
    let expected: f64 = asset
        .transfer
        .coefficients
        .iter()
        .map(|&c| f64::from(c))
        .sum();
    // Both sum the same numbers in f64, in another order.
    let magnitude: f64 = asset
        .transfer
        .coefficients
        .iter()
        .map(|&c| f64::from(c.abs()))
        .sum();
    assert!((sum.parse::<f64>().unwrap() - expected).abs() <= 1e-12 * magnitude);
    assert_eq!(count, asset.transfer.vertex_count().to_string());
}

#[test]
fn light_of_vertices_is_written_in_the_order_of_rows_and_comes_back() {
    let (asset, world, _) = exported();
    let count = world.positions.len();
    let coefficients = (0..4 * count).map(|i| [i as f32, 0.5, -1.0]).collect();
    let light = VertexLight::new(crate::basis::Order::new(2).unwrap(), coefficients);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("light.npz");
    export_light(&world, &asset.transfer.valid, &light, &path).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let (shape, values) = array::<f32>(&bytes, "coefficients");
    assert_eq!(shape, [count as u64, 4, 3]);
    for (row, vertex) in values.chunks(12).zip(expected_rows(&world)) {
        assert_eq!(row, light.coefficients(vertex).as_flattened());
    }
    assert_eq!(import_light(&world, &path).unwrap(), light);
    let mut other = world.clone();
    other.positions.pop();
    let message = import_light(&other, &path).unwrap_err().to_string();
    assert!(message.contains("--for"), "{message}");
}
