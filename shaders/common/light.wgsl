// Sky, sun, haze and the way to the display, shared by everything that is lit.
//
// Light is computed at the vertices. In software a fragment shader runs for whole blocks of pixels,
// and a construction model's triangles are mostly smaller than a block: light per pixel would cost
// several times as much, and on even faces it looks the same.

const SUN: vec3<f32> = vec3<f32>(2.35, 2.08, 1.72);
const ZENITH: vec3<f32> = vec3<f32>(0.26, 0.46, 0.76);
const HORIZON: vec3<f32> = vec3<f32>(0.80, 0.86, 0.92);
const EARTH: vec3<f32> = vec3<f32>(0.46, 0.44, 0.41);
// What is left of all light by night: dim and blue, but readable.
const NIGHT: vec3<f32> = vec3<f32>(0.20, 0.26, 0.40);
// Light from all around, from above and from below (cool against warm).
const AMBIENT_ABOVE: vec3<f32> = vec3<f32>(0.60, 0.72, 0.92);
const AMBIENT_BELOW: vec3<f32> = vec3<f32>(0.36, 0.33, 0.30);

// What is mirrored from a unit direction.
fn sky(direction: vec3<f32>) -> vec3<f32> {
    let low = 1.0 - clamp(direction.y, 0.0, 1.0);
    let above = mix(ZENITH, HORIZON, low * low * low);
    return mix(above, EARTH, clamp(direction.y * -6.0, 0.0, 1.0));
}

struct Surface {
    color: vec3<f32>,
    roughness: f32,
    metallic: f32,
}

// Light that a surface sends to the eye. All vectors are units; `normal` faces the eye.
fn shade(s: Surface, normal: vec3<f32>, to_eye: vec3<f32>, height: f32) -> vec3<f32> {
    let diffuse = s.color * (1.0 - s.metallic);
    let f0 = mix(vec3<f32>(0.04), s.color, s.metallic);
    let n_sun = dot(normal, frame.sun);
    let lit = max(n_sun, 0.0);

    // Open sky above, the earth's bounce below; walls get a little darker towards the ground.
    let openness = 0.80 + 0.20 * clamp(height / frame.height_m * 3.0, 0.0, 1.0);
    let ambient = mix(AMBIENT_BELOW, AMBIENT_ABOVE, normal.y * 0.5 + 0.5) * openness;
    // The side away from the sun is told apart by a faint cool light from there.
    let fill = max(-n_sun, 0.0) * vec3<f32>(0.05, 0.08, 0.13);

    let half_way = normalize(frame.sun + to_eye);
    let n_half = max(dot(normal, half_way), 0.0);
    let sun_half = max(dot(frame.sun, half_way), 0.1);
    let rough = max(s.roughness, 0.15);
    let a2 = rough * rough * rough * rough;
    let d = n_half * n_half * (a2 - 1.0) + 1.0;
    let glint = a2 / (d * d * sun_half * sun_half * (rough * 4.0 + 2.0)) * lit;

    let n_eye = clamp(dot(normal, to_eye), 0.0, 1.0);
    let grazing = (1.0 - n_eye) * (1.0 - n_eye);
    let smoothness = 1.0 - s.roughness;
    let fresnel = f0 + (max(vec3<f32>(smoothness), f0) - f0) * grazing * grazing * (1.0 - n_eye);
    let mirrored = sky(reflect(-to_eye, normal));
    let blurred = mix(mirrored, ambient, s.roughness);

    return diffuse * (SUN * lit * 0.74 + ambient * 0.52 + fill)
        + f0 * SUN * min(glint, 8.0)
        + fresnel * blurred * mix(0.35, 1.0, s.metallic);
}

// Far things take on the colour of the horizon.
fn haze(color: vec3<f32>, distance: f32) -> vec3<f32> {
    let share = 0.55 * (1.0 - exp(-distance / frame.haze_m));
    return mix(color, HORIZON, share);
}

// Open range to display range: exact below the knee, above it a soft shoulder that keeps the hue.
fn tonemap(color: vec3<f32>) -> vec3<f32> {
    let knee = 0.72;
    let peak = max(color.r, max(color.g, color.b));
    let room = 1.0 - knee;
    let over = max(peak - knee, 0.0);
    let new_peak = min(peak, knee) + room * over / (over + room);
    let scaled = color * (new_peak / max(peak, 1e-4));
    let white = over / (over + 1.5);
    return mix(scaled, vec3<f32>(new_peak), white * 0.6);
}

// Linear to sRGB, within 0.003 of the standard's curve, at the price of one square root.
fn encode(color: vec3<f32>) -> vec3<f32> {
    let c = clamp(color, vec3<f32>(0.0), vec3<f32>(1.0));
    let s = sqrt(c);
    let curve = -0.03090 + s * (1.34386 + s * (-0.50598 + s * 0.19302));
    return select(curve, c * 12.92, c < vec3<f32>(0.0031308));
}

fn display(color: vec3<f32>, distance: f32) -> vec3<f32> {
    return encode(tonemap(haze(color, distance) * mix(NIGHT, vec3<f32>(1.0), frame.day)));
}
