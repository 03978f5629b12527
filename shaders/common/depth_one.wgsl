@group(0) @binding(3) var depth: texture_depth_2d;
