@group(0) @binding(1) var depth: texture_depth_2d;
