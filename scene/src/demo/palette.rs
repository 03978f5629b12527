//! The surfaces of the demo project.

use crate::Material;

/// Index into the demo's materials.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub(super) struct Paint(pub(super) u16);

impl Paint {
    pub(super) fn transparent(self) -> bool {
        TABLE[usize::from(self.0)].2 < 1.0
    }
}

macro_rules! palette {
    ($($name:ident $text:literal $rgb:literal $alpha:literal $rough:literal $metal:literal;)*) => {
        #[allow(non_camel_case_types, clippy::upper_case_acronyms)]
        enum Order { $($name),* }
        $(pub(super) const $name: Paint = Paint(Order::$name as u16);)*
        const TABLE: &[(&str, u32, f32, f32, f32)] = &[$(($text, $rgb, $alpha, $rough, $metal)),*];
    };
}

// name, sRGB colour, alpha, roughness, metallic
palette! {
    CONCRETE "Concrete" 0xb3aca1 1.0 0.90 0.0;
    CONCRETE_DARK "Concrete, core" 0x9a938a 1.0 0.90 0.0;
    CONCRETE_LIGHT "Concrete, precast" 0xc9c3b8 1.0 0.85 0.0;
    CONCRETE_RAW "Concrete, foundation" 0x8d867c 1.0 0.95 0.0;
    STONE "Limestone" 0xd8cdb8 1.0 0.60 0.0;
    STEEL "Galvanised steel" 0xa9b0b4 1.0 0.45 0.8;
    STEEL_DARK "Painted steel" 0x4a5056 1.0 0.50 0.5;
    ALU "Anodised aluminium" 0xb8bcc0 1.0 0.35 0.7;
    ALU_DARK "Aluminium, anthracite" 0x3b4147 1.0 0.40 0.5;
    BRONZE "Aluminium, bronze" 0x96744c 1.0 0.40 0.6;
    GLASS "Vision glass" 0x8fb8cc 0.35 0.06 0.0;
    GLASS_CLEAR "Clear glass" 0xb9d6d8 0.28 0.05 0.0;
    GLASS_DEEP "Crown glass" 0x77a4bd 0.42 0.06 0.0;
    SPANDREL "Spandrel, slate" 0x4d606e 1.0 0.30 0.2;
    SPANDREL_PALE "Spandrel, champagne" 0xb9aa90 1.0 0.40 0.3;
    LOUVRE "Louvre" 0x5d6468 1.0 0.50 0.5;
    GYPSUM "Plasterboard" 0xe4e0d8 1.0 0.90 0.0;
    CEILING "Ceiling" 0xefece6 1.0 0.90 0.0;
    CARPET "Carpet" 0x6f7780 1.0 1.00 0.0;
    PARQUET "Parquet" 0xa77f58 1.0 0.70 0.0;
    DOOR_WOOD "Door, oak" 0xa9784a 1.0 0.60 0.0;
    DOOR_STEEL "Door, steel" 0x7d8890 1.0 0.50 0.4;
    BRICK "Brick" 0x9c5a44 1.0 0.95 0.0;
    BRICK_DARK "Brick, dark" 0x7c4537 1.0 0.95 0.0;
    ROOF_TILE "Roof tile" 0x8a4a3a 1.0 0.90 0.0;
    TIMBER "Timber" 0xc39a63 1.0 0.80 0.0;
    TIMBER_OLD "Timber, weathered" 0x8b7558 1.0 0.90 0.0;
    FORM_PANEL "Formwork ply" 0xc98d4a 1.0 0.70 0.0;
    FORM_BEAM "Formwork girder" 0xe5b829 1.0 0.60 0.0;
    ORANGE "Safety orange" 0xee6a1c 1.0 0.60 0.0;
    YELLOW "Machine yellow" 0xf0b41e 1.0 0.45 0.1;
    CRANE "Crane yellow" 0xf2c21b 1.0 0.45 0.1;
    RED "Signal red" 0xc23b2c 1.0 0.50 0.0;
    SCREEN "Safety screen" 0x3e7fb0 1.0 0.70 0.0;
    NET "Debris net" 0x58a05a 0.55 0.90 0.0;
    SCAFFOLD "Scaffold tube" 0xb5bbc0 1.0 0.40 0.7;
    WHITE "White" 0xf0efec 1.0 0.60 0.0;
    BLACK "Black" 0x24262a 1.0 0.60 0.0;
    RUBBER "Rubber" 0x2c2c2e 1.0 0.95 0.0;
    CABIN "Cabin panel" 0xe2e5e4 1.0 0.60 0.1;
    CABIN_BLUE "Cabin trim" 0x2f6ea3 1.0 0.55 0.1;
    ASPHALT "Asphalt" 0x56585b 1.0 0.95 0.0;
    PAVING "Paving" 0xb4aea4 1.0 0.90 0.0;
    PAVING_DARK "Paving, granite" 0x8e8a85 1.0 0.85 0.0;
    KERB "Kerb" 0xcac6bd 1.0 0.90 0.0;
    MARKING "Road marking" 0xe8e6de 1.0 0.80 0.0;
    GRASS "Lawn" 0x7d9a55 1.0 1.00 0.0;
    GREEN_ROOF "Sedum roof" 0x8b9a5d 1.0 1.00 0.0;
    GRAVEL "Gravel" 0xa59d8f 1.0 1.00 0.0;
    SOIL "Soil" 0x8c6f52 1.0 1.00 0.0;
    SOIL_DARK "Soil, deep" 0x75593f 1.0 1.00 0.0;
    LEAF_A "Leaves, lime" 0x6f9a45 1.0 0.90 0.0;
    LEAF_B "Leaves, plane" 0x557f3c 1.0 0.90 0.0;
    LEAF_C "Leaves, maple" 0x87a24b 1.0 0.90 0.0;
    BARK "Bark" 0x6b5844 1.0 0.95 0.0;
    PIPE_RED "Sprinkler pipe" 0xb3372d 1.0 0.50 0.1;
    PIPE_BLUE "Cold water pipe" 0x3d78a8 1.0 0.50 0.1;
    COPPER "Copper pipe" 0xb87347 1.0 0.40 0.8;
    DUCT "Duct" 0xb9bec1 1.0 0.40 0.7;
    TRAY "Cable tray" 0x8f979b 1.0 0.50 0.6;
    LUMINAIRE "Luminaire" 0xfdf6e0 1.0 0.40 0.0;
    CAR_RED "Car paint, red" 0xa32f2b 1.0 0.25 0.2;
    CAR_BLUE "Car paint, blue" 0x2c5180 1.0 0.25 0.2;
    CAR_SILVER "Car paint, silver" 0xb4b8bb 1.0 0.25 0.5;
    CAR_BLACK "Car paint, black" 0x2f3236 1.0 0.25 0.2;
    CAR_GLASS "Car glass" 0x39464f 1.0 0.10 0.0;
    SKIN "Skin" 0xc99b7a 1.0 0.80 0.0;
    JEANS "Work trousers" 0x3f4d66 1.0 0.90 0.0;
    WINDOW "Window glass" 0x526a79 1.0 0.12 0.1;
    HOUSE_CREAM "Render, cream" 0xdccfb4 1.0 0.90 0.0;
    HOUSE_GREY "Render, grey" 0xb0b0ab 1.0 0.90 0.0;
    HOUSE_SAND "Sandstone" 0xc7ad86 1.0 0.90 0.0;
    HOUSE_BRICK "Brick, neighbour" 0xa7705a 1.0 0.95 0.0;
    HOUSE_WHITE "Render, white" 0xe3e0da 1.0 0.90 0.0;
    ZINC "Zinc roof" 0x7b8489 1.0 0.50 0.5;
}

/// All materials in the order of the constants; colours linear.
pub(super) fn materials() -> Vec<Material> {
    TABLE
        .iter()
        .map(|&(name, rgb, alpha, roughness, metallic)| Material {
            name: name.to_owned(),
            color: [linear(rgb >> 16), linear(rgb >> 8), linear(rgb), alpha],
            roughness,
            metallic,
            transparent: alpha < 1.0,
        })
        .collect()
}

/// One sRGB byte (the lowest of `value`) as a linear share; a cubic fit, exact enough for colours
/// and the same on every machine.
fn linear(value: u32) -> f32 {
    let c = (value & 0xff) as f32 / 255.0;
    c * (c * (c * 0.305_306 + 0.682_171_1) + 0.012_522_9)
}
