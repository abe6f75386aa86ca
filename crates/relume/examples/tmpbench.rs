//! tmp
use glam::*;
use relume::{bake::*, basis::Order, scene::*};
use std::sync::atomic::AtomicBool;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let text = std::fs::read_to_string(&a[1]).unwrap();
    let mut p = vec![];
    let mut t: Vec<[u32; 3]> = vec![];
    for l in text.lines() {
        let w: Vec<&str> = l.split_whitespace().collect();
        match w.first() {
            Some(&"v") => p.push(Vec3::new(
                w[1].parse().unwrap(),
                w[2].parse().unwrap(),
                w[3].parse().unwrap(),
            )),
            Some(&"f") => {
                let i: Vec<u32> = w[1..]
                    .iter()
                    .map(|x| x.split('/').next().unwrap().parse::<u32>().unwrap() - 1)
                    .collect();
                t.push([i[0], i[1], i[2]]);
            }
            _ => {}
        }
    }
    let mut n = vec![Vec3::ZERO; p.len()];
    for &[a, b, c] in &t {
        let g = (p[b as usize] - p[a as usize]).cross(p[c as usize] - p[a as usize]);
        for i in [a, b, c] {
            n[i as usize] += g;
        }
    }
    let n: Vec<Vec3> = n.into_iter().map(|v| v.normalize_or(Vec3::Y)).collect();
    let k = p.len();
    let mesh = Mesh {
        positions: p,
        normals: n,
        groups: vec![Group {
            material: 0,
            triangles: t,
        }],
        input_vertices: k,
        ..Mesh::default()
    };
    let s = Scene {
        meshes: vec![mesh],
        materials: vec![Material::diffuse("g", [0.5; 3])],
        instances: vec![Instance {
            mesh: 0,
            node: 0,
            primitive: 0,
            world_from_object: DAffine3::IDENTITY,
        }],
        ..Scene::default()
    };
    let w = World::new(&s);
    let t0 = std::time::Instant::now();
    let _ = trace::Tracer::new(&w);
    println!("build {:?}", t0.elapsed());
    for (b, th) in [(0, 1), (1, 1)] {
        let o = BakeOptions {
            order: Order::new(5).unwrap(),
            samples: a[2].parse().unwrap(),
            bounces: b,
            threads: Some(th),
            ..Default::default()
        };
        let t0 = std::time::Instant::now();
        let c0 = cpu();
        let c = AtomicBool::new(false);
        let r = bake(
            &w,
            &o,
            &Monitor {
                progress: &|_| {},
                cancelled: &c,
            },
        )
        .unwrap();
        let e = cpu() - c0;
        println!(
            "bounces {b} threads {th}: {e:.2}s {:.2} Mrays/s invalid {} sum {}",
            k as f64 * o.samples as f64 * (1 + b) as f64 / e / 1e6,
            r.valid.iter().filter(|v| !**v).count(),
            r.coefficients.iter().sum::<f32>()
        );
    }
}

fn cpu() -> f64 {
    let s = std::fs::read_to_string("/proc/self/stat").unwrap();
    let w: Vec<&str> = s.rsplit(')').next().unwrap().split_whitespace().collect();
    w[11].parse::<f64>().unwrap() / 100.0
}
