//! Where light comes from: a fixed sun, or the one that a place has at the instant that is shown.

use glam::{DVec3, Vec3};
use topout_schedule::Time;

/// The light of a picture.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub enum Sun {
    /// The same at every instant: each side of a building has its own tone.
    #[default]
    Fixed,
    /// As at this place, degrees north and east. North is -Z, east +X; clocks show the hour of the
    /// nearest full 15 degrees, without summer time.
    Place {
        /// In [-90, 90].
        latitude_deg: f32,
        /// In [-180, 180].
        longitude_deg: f32,
    },
}

/// Direction and strength.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Light {
    /// Unit, towards where it comes from.
    pub toward: Vec3,
    /// 1 by day, 0 by night.
    pub day: f32,
}

/// Sine of the 6 degrees of civil twilight.
const DUSK: f32 = 0.104_528;

impl Sun {
    /// The light at an instant. By night it comes softly from where the fixed sun stands, so that everything
    /// stays readable; between 6 degrees above the horizon and 6 below one becomes the other.
    pub(crate) fn light(self, time: Time) -> Light {
        let Self::Place { latitude_deg, longitude_deg } = self else {
            return Light { toward: fixed(), day: 1.0 };
        };
        let zone_hours = (f64::from(longitude_deg) / 15.0).round();
        let utc_seconds = time.seconds() as f64 - zone_hours * 3600.0;
        let sun = position(utc_seconds, latitude_deg.into(), longitude_deg.into()).as_vec3();
        let t = ((sun.y / DUSK + 1.0) * 0.5).clamp(0.0, 1.0);
        let day = t * t * (3.0 - 2.0 * t);
        // Light from below the ground would fall on floors from underneath.
        let low = Vec3::new(sun.x, sun.y.max(0.05), sun.z).normalize();
        Light { toward: fixed().lerp(low, day).try_normalize().unwrap_or_else(fixed), day }
    }
}

/// Azimuth 68 degrees from +Z towards +X, 44 degrees high. Of the standard view's (azimuth 30,
/// elevation 20) three visible sides, top, right and left, each gets its own tone.
pub(crate) fn fixed() -> Vec3 {
    let (azimuth, elevation) = (68.0f32.to_radians(), 44.0f32.to_radians());
    Vec3::new(azimuth.sin() * elevation.cos(), elevation.sin(), azimuth.cos() * elevation.cos())
}

/// Unit vector towards the middle of the sun, without refraction: the equations of NOAA's solar calculator
/// (after Meeus, Astronomical Algorithms), good to some hundredths of a degree from 1900 to 2100.
/// `utc_seconds` since 1970; degrees north and east.
fn position(utc_seconds: f64, latitude_deg: f64, longitude_deg: f64) -> DVec3 {
    // Julian centuries since the beginning of 2000.
    let c = (utc_seconds / 86_400.0 - 10_957.5) / 36_525.0;
    let mean_longitude = (280.46646 + c * (36000.76983 + c * 0.0003032)).to_radians();
    let anomaly = (357.52911 + c * (35999.05029 - c * 0.0001537)).to_radians();
    let eccentricity = 0.016708634 - c * (0.000042037 + c * 0.0000001267);
    let center = anomaly.sin() * (1.914602 - c * (0.004817 + c * 0.000014))
        + (2.0 * anomaly).sin() * (0.019993 - c * 0.000101)
        + (3.0 * anomaly).sin() * 0.000289;
    let node = (125.04 - 1934.136 * c).to_radians();
    let longitude = mean_longitude + (center - 0.00569 - 0.00478 * node.sin()).to_radians();
    let obliquity_deg = 23.0
        + (26.0 + (21.448 - c * (46.815 + c * (0.00059 - c * 0.001813))) / 60.0) / 60.0
        + 0.00256 * node.cos();
    let obliquity = obliquity_deg.to_radians();
    let declination = (obliquity.sin() * longitude.sin()).asin();
    // How far the sun is ahead of the clock, radians.
    let y = (obliquity / 2.0).tan().powi(2);
    let ahead = y * (2.0 * mean_longitude).sin() - 2.0 * eccentricity * anomaly.sin()
        + 4.0 * eccentricity * y * anomaly.sin() * (2.0 * mean_longitude).cos()
        - 0.5 * y * y * (4.0 * mean_longitude).sin()
        - 1.25 * eccentricity * eccentricity * (2.0 * anomaly).sin();
    let turn = (utc_seconds / 86_400.0).rem_euclid(1.0) * std::f64::consts::TAU;
    let hour_angle = turn + ahead + longitude_deg.to_radians() - std::f64::consts::PI;
    let latitude = latitude_deg.to_radians();
    let (sin_d, cos_d) = declination.sin_cos();
    let east = -cos_d * hour_angle.sin();
    let north = sin_d * latitude.cos() - cos_d * latitude.sin() * hour_angle.cos();
    let up = sin_d * latitude.sin() + cos_d * latitude.cos() * hour_angle.cos();
    DVec3::new(east, up, -north)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    fn seconds(text: &str) -> f64 {
        Time::parse_iso(text).unwrap().seconds() as f64
    }

    /// Azimuth from north over east, and elevation, degrees.
    fn angles(sun: DVec3) -> (f64, f64) {
        (sun.x.atan2(-sun.z).to_degrees().rem_euclid(360.0), sun.y.asin().to_degrees())
    }

    #[test]
    fn the_sun_stands_where_it_was_published() {
        // The worked example of NREL's Solar Position Algorithm (Reda and Andreas, 2008): zenith 50.11162
        // with 0.02 of refraction, azimuth 194.34024. Then noon at Greenwich and in Sydney at the solstices
        // of 2024, when the declination is 23.44.
        for (utc, latitude, longitude, azimuth, elevation) in [
            ("2003-10-17T19:30:30", 39.742476, -105.1786, 194.34, 39.87),
            ("2024-06-20T12:01:44", 51.4779, 0.0, 180.0, 61.96),
            ("2024-12-21T11:58:14", 51.4779, 0.0, 180.0, 15.08),
            ("2024-12-21T01:53:16", -33.8688, 151.2093, 360.0, 79.57),
        ] {
            let (a, e) = angles(position(seconds(utc), latitude, longitude));
            let turn = (a - azimuth + 180.0).rem_euclid(360.0) - 180.0;
            assert!(turn.abs() * e.to_radians().cos() < 0.05, "{utc}: {a} for {azimuth}");
            assert!((e - elevation).abs() < 0.05, "{utc}: {e} for {elevation}");
        }
    }

    #[test]
    fn nights_are_soft_and_days_are_bright() {
        let berlin = Sun::Place { latitude_deg: 52.5, longitude_deg: 13.4 };
        let light = |text| berlin.light(Time::parse_iso(text).unwrap());
        let (noon, night) = (light("2026-06-21T12:00:00"), light("2026-06-21T00:00:00"));
        assert_eq!((noon.day, night.day), (1.0, 0.0));
        assert_eq!(night.toward, fixed());
        assert!(noon.toward.z > 0.3 && noon.toward.y > 0.8, "{noon:?}");
        assert!(light("2026-06-21T07:00:00").toward.x > 0.5);
        let dusk = light("2026-03-20T18:10:00");
        assert!(dusk.day > 0.0 && dusk.day < 1.0 && dusk.toward.is_normalized(), "{dusk:?}");
        assert_eq!(Sun::Fixed.light(Time::default()).toward, fixed());
    }
}
