//! Exposure and the filmic curve, from scene radiance to 8-bit sRGB.

/// How scene radiance becomes a picture: exposure in stops, then a filmic curve, then the sRGB encoding [iec61966], by channel.
///
/// The curve is Narkowicz's fit of the ACES reference rendering for SDR displays [narkowicz2016], with the factor 0.6 he gives for the
/// brightness of the original:
///
/// ```text
/// x = 0.6 · 2^exposure · radiance,    y = min(1, x(2.51x + 0.03) / (x(2.43x + 0.59) + 0.14))
/// ```
///
/// It rises strictly until it reaches 1 (at a radiance of 12.1 for exposure 0) and maps 0 to 0. Negative radiance and NaN become 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToneMap {
    /// In stops: radiance is multiplied by 2^`exposure` first.
    pub exposure: f32,
}

impl ToneMap {
    /// The linear display value, 0…1, of one channel.
    pub fn curve(&self, radiance: f32) -> f64 {
        let x = 0.6 * f64::from(radiance) * libm::exp2(f64::from(self.exposure));
        if x.is_nan() || x <= 0.0 {
            return 0.0;
        }
        // Above this the curve has long reached 1, and squares of what is far above would overflow.
        let x = x.min(1e6);
        (x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)).min(1.0)
    }

    /// The 8-bit sRGB code of each channel.
    pub fn encode(&self, radiance: [f32; 3]) -> [u8; 3] {
        radiance.map(|x| srgb_code(self.curve(x)))
    }
}

/// The nearest 8-bit sRGB code of a linear value in 0…1 [iec61966].
pub fn srgb_code(linear: f64) -> u8 {
    let encoded = if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * libm::pow(linear, 1.0 / 2.4) - 0.055
    };
    (encoded * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Texture;

    #[test]
    fn the_curve_rises_from_nothing_to_one_and_is_never_nan() {
        let tone = ToneMap::default();
        assert_eq!(tone.curve(0.0), 0.0);
        let mut before = 0.0;
        for step in 1..=1000 {
            let value = tone.curve(12.0 * step as f32 / 1000.0);
            assert!(value > before && value < 1.0, "step {step}");
            before = value;
        }
        assert_eq!(tone.curve(12.2), 1.0);
        for (radiance, value) in [
            (f32::INFINITY, 1.0),
            (f32::MAX, 1.0),
            (-1.0, 0.0),
            (f32::NEG_INFINITY, 0.0),
            (f32::NAN, 0.0),
        ] {
            assert_eq!(tone.curve(radiance), value, "{radiance}");
        }
        let blinding = ToneMap {
            exposure: f32::INFINITY,
        };
        assert_eq!(blinding.encode([0.0, 1.0, f32::NAN]), [0, 255, 0]);
    }

    #[test]
    fn a_stop_doubles_radiance() {
        let brighter = ToneMap { exposure: 1.0 };
        assert_eq!(brighter.curve(0.25), ToneMap::default().curve(0.5));
    }

    #[test]
    fn encoding_inverts_the_decoding_of_textures() {
        for code in 0..=255_u8 {
            let texture = Texture {
                width: 1,
                height: 1,
                texels: vec![[code; 4]],
                sampler: Default::default(),
            };
            let linear = texture.sample(glam::Vec2::splat(0.5)).0.x;
            assert_eq!(srgb_code(f64::from(linear)), code);
        }
    }
}
