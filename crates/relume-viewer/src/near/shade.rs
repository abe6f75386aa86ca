//! What a diffuse scene makes of distant and near light together.

use relume::asset::{Transfer, TransferKind};
use relume::light::{IncidentLight, ShLight};
use relume::shade::{BounceError, SideRadiance, bounced, bounced_with};

use super::NearLight;
use crate::content::{Content, Paths};

/// Transferred radiance of every side.
///
/// Bounces that were folded into transfer hold for distant light alone, so near light then comes by a transfer of direct light, and bounces by its gather
/// operator, `bounces` times, if it has one. Where none was folded, all light bounces so.
///
/// # Errors
/// Bounces that the transfer cannot make; it is never asked for such.
pub fn shade(
    content: &mut Content,
    paths: Paths,
    distant: &ShLight,
    near: Option<&NearLight>,
    bounces: u32,
) -> Result<SideRadiance, BounceError> {
    let far = IncidentLight::Distant(distant.clone());
    let Some(shown) = content.transfer(paths) else {
        return Ok(SideRadiance::default());
    };
    let folded = matches!(shown.kind, TransferKind::Shadowed { bounces: 1.. });
    let possible = |transfer: &Transfer| {
        let gathers = transfer.gather.is_some() && transfer.matrices.is_none();
        let asked = if paths == Paths::Baked { bounces } else { 0 };
        if gathers { asked } else { 0 }
    };
    if !folded {
        let light = match near {
            Some(near) => IncidentLight::PerVertex(near.light.plus(distant)),
            None => far,
        };
        let enclosed = near.and_then(NearLight::enclosed_direct);
        return bounced_with(shown, &light, enclosed, possible(shown));
    }
    let mut sides = bounced(shown, &far, 0)?;
    let Some((near, direct)) = near.zip(content.direct()) else {
        return Ok(sides);
    };
    let light = IncidentLight::PerVertex(near.light.clone());
    let enclosed = near.enclosed_direct();
    let added = bounced_with(direct, &light, enclosed, possible(direct))?;
    sides.add(&added);
    Ok(sides)
}

/// How far `found` is from `exact`: their differences `gain` times, and their root mean square with the brightest channel of any vertex as 1.
pub fn error(found: &SideRadiance, exact: &SideRadiance, gain: f32) -> (SideRadiance, f32) {
    let difference = |found: &[[f32; 3]], exact: &[[f32; 3]]| -> Vec<[f32; 3]> {
        let pairs = found.iter().zip(exact);
        pairs
            .map(|(a, b)| std::array::from_fn(|c| gain * (a[c] - b[c])))
            .collect()
    };
    let front = difference(&found.front, &exact.front);
    let values = || front.iter().flatten().map(|&x| f64::from(x / gain));
    let mean = values().map(|x| x * x).sum::<f64>() / (3 * front.len()).max(1) as f64;
    let brightest = exact.front.iter().flatten().fold(0.0_f32, |a, &b| a.max(b));
    let relative = mean.sqrt() / f64::from(brightest.max(f32::MIN_POSITIVE));
    let back = difference(&found.back, &exact.back);
    (SideRadiance { front, back }, relative as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::near::{Arriving, Made, Near};
    use glam::DVec3;
    use relume::asset::Asset;
    use relume::bake::{BakeOptions, Monitor, bake};
    use relume::basis::Order;
    use relume::scene::{World, bundled};
    use relume::shade::Split;

    fn baked(bounces: u32, gather: bool) -> Content {
        let scene = bundled::bowl(0.7, 0.6, 16);
        let options = BakeOptions {
            order: Order::new(3).unwrap(),
            samples: 64,
            bounces,
            gather,
            ..BakeOptions::default()
        };
        let monitor = Monitor {
            progress: &|_| (),
            cancelled: &false.into(),
        };
        let transfer = bake(&World::new(&scene), &options, &monitor)
            .unwrap()
            .transfer;
        Content::new("bowl".to_owned(), Asset { scene, transfer })
    }

    fn sum(sides: &SideRadiance) -> f32 {
        sides.front.iter().flatten().sum()
    }

    #[test]
    fn folded_bounces_and_those_of_the_gather_operator_agree_and_near_light_never_takes_the_folded()
    {
        let (mut folded, mut gathered) = (baked(2, false), baked(0, true));
        let order = folded.asset.transfer.order;
        let coefficients = (0..9).map(|i| [3.0 / (1.0 + i as f32), 1.0, 0.5]);
        let distant = ShLight::new(order, coefficients.collect());
        let one = shade(&mut folded, Paths::Baked, &distant, None, 2).unwrap();
        let other = shade(&mut gathered, Paths::Baked, &distant, None, 2).unwrap();
        assert!((sum(&one) - sum(&other)).abs() < 1e-3 * sum(&one));
        let mut near = Near::default();
        near.add(Made::Panel.lamp(0.5, DVec3::new(0.1, 1.5, 0.2), DVec3::ZERO));
        let mut arriving = Arriving::new(&gathered.world, &gathered.asset.transfer);
        let transfer = &gathered.asset.transfer;
        let light = arriving.arrive(&near, None, &gathered.world, transfer).near;
        let lit = shade(&mut gathered, Paths::Baked, &distant, Some(&light), 2).unwrap();
        // Without direct transfer of its own: unshadowed, once; with it, the same as the other.
        let without = shade(&mut folded, Paths::Baked, &distant, Some(&light), 2).unwrap();
        assert!(sum(&without) > sum(&one));
        folded.shadowed = Some(gathered.asset.transfer.clone());
        let with = shade(&mut folded, Paths::Baked, &distant, Some(&light), 2).unwrap();
        assert!((sum(&with) - sum(&lit)).abs() < 1e-3 * sum(&lit));
        let direct = shade(&mut gathered, Paths::Shadowed, &distant, Some(&light), 2).unwrap();
        assert!(sum(&direct) < 0.99 * sum(&lit));
    }

    #[test]
    fn lamps_within_the_scene_light_it_from_where_they_stand() {
        let mut content = baked(0, true);
        let dark = ShLight::new(content.asset.transfer.order, vec![[0.0; 3]; 9]);
        let mut near = Near::default();
        near.add(Made::Ball.lamp(0.3, DVec3::new(0.1, -0.2, 0.0), DVec3::ZERO));
        let mut arriving = Arriving::new(&content.world, &content.asset.transfer);
        let mut lit = |near: &Near| {
            let split = Split::new(&content.world, near.placed());
            let (world, transfer) = (&content.world, &content.asset.transfer);
            assert!(split.is_some());
            let light = arriving.arrive(near, split.as_ref(), world, transfer).near;
            let lit = shade(&mut content, Paths::Baked, &dark, Some(&light), 1);
            sum(&lit.unwrap())
        };
        let before = lit(&near);
        assert!(before > 0.1 && lit(&near) == before, "{before}");
        // Brighter, and elsewhere: never what it was.
        let mut lamp = near.lamps()[0].clone();
        lamp.strength *= 2.0;
        near.edit(0, lamp.clone()).unwrap();
        assert!((lit(&near) - 2.0 * before).abs() < 1e-4 * before);
        lamp.emitter.world_from_emitter.translation.y += 0.3;
        near.edit(0, lamp).unwrap();
        assert!((lit(&near) - 2.0 * before).abs() > 0.01 * before);
    }

    #[test]
    fn errors_are_relative_to_the_brightest() {
        let sides = |x: f32| SideRadiance {
            front: vec![[x, 2.0, 0.0], [0.0; 3]],
            back: vec![[x; 3]],
        };
        let (shown, rmse) = error(&sides(1.5), &sides(1.0), 4.0);
        assert_eq!(shown.front[0], [2.0, 0.0, 0.0]);
        assert_eq!(shown.back[0], [2.0; 3]);
        assert!((rmse - 0.5 / 6.0_f32.sqrt() / 2.0).abs() < 1e-6);
    }
}
