// Boxes of triangles and of groups of them, for the list of the cloth's pairs with itself. Groups are 16 triangles in self_order, which
// keeps neighbours together.
#include "self_box.glsl"
uint self_groups() { return (TRIANGLES + PIECES_A_GROUP - 1u) / PIECES_A_GROUP; }

void boxes_of_group(uint g) {
  SelfBox group = SelfBox(vec4(1e30), vec4(-1e30), vec4(1e30), vec4(-1e30));
  for (uint q = PIECES_A_GROUP * g; q < min(PIECES_A_GROUP * (g + 1u), TRIANGLES); ++q) {
    uvec4 e = LOAD16(elements, LOAD4(self_order, q));
    SelfBox box = SelfBox(vec4(1e30), vec4(-1e30), vec4(1e30), vec4(-1e30));
    for (uint c = 0u; c < 3u; ++c) {
      vec4 r = LOAD16(reaches, e[c]);
      float half_m = 0.5 * THICKNESS_M;
      box.low_0.xyz = min(box.low_0.xyz, r.xyz - half_m);
      box.high_0.xyz = max(box.high_0.xyz, r.xyz + half_m);
      box.low_1.xyz = min(box.low_1.xyz, r.xyz - (half_m + r.w));
      box.high_1.xyz = max(box.high_1.xyz, r.xyz + (half_m + r.w));
    }
    STORE64(self_boxes, q, box);
    group.low_0.xyz = min(group.low_0.xyz, low_at(box, 1.0));
    group.high_0.xyz = max(group.high_0.xyz, high_at(box, 1.0));
  }
  group.low_1 = group.low_0;  // so that rounding does not part it from a triangle of its own
  group.high_1 = group.high_0;
  STORE64(self_boxes, TRIANGLES + g, group);
}
