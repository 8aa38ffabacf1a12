#version 450
#include "../render_shared.h"
layout(constant_id = 0) const bool kCloth = true;
layout(push_constant) uniform Constants { Drawn d; };
layout(location = 0) in vec3 in_position;
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec2 in_square;
layout(location = 3) flat in int in_look;
layout(location = 0) out vec4 out_colour;

// sRGB colours; colour-blind readers can also tell orange from blue.
const vec3 kFront[2] = vec3[](vec3(0.80, 0.42, 0.13), vec3(0.97, 0.80, 0.58));
const vec3 kBack[2] = vec3[](vec3(0.16, 0.41, 0.69), vec3(0.64, 0.79, 0.93));
const vec3 kCollider = vec3(0.72, 0.71, 0.68), kMark = vec3(0.20, 0.20, 0.22);

vec3 linear(vec3 srgb) { return pow(srgb, vec3(2.2)); }

// Fraction of a pixel that odd squares cover: the square wave, integrated over the pixel's width (Quilez 2010, "filtering
// the checkerboard pattern").
float checker(vec2 p) {
  const vec2 w = max(fwidth(p), vec2(1e-4));
  const vec2 i = 2 * (abs(fract((p - 0.5 * w) * 0.5) - 0.5) - abs(fract((p + 0.5 * w) * 0.5) - 0.5)) / w;
  return 0.5 - 0.5 * i.x * i.y;
}

vec3 surface_colour() {
  if (!kCloth) return linear(in_look == LOOK_MARK ? kMark : kCollider);
  const float odd = checker(in_square);
  return gl_FrontFacing ? mix(linear(kFront[0]), linear(kFront[1]), odd) : mix(linear(kBack[0]), linear(kBack[1]), odd);
}

void main() {
  const vec3 towards = normalize(d.eye.xyz - in_position);
  // Normal of the triangle, turned towards the viewer, so that both sides are lit alike.
  vec3 flat_normal = cross(dFdx(in_position), dFdy(in_position));
  flat_normal /= max(length(flat_normal), 1e-30);
  if (dot(flat_normal, towards) < 0) flat_normal = -flat_normal;
  vec3 n = in_look == LOOK_FLAT ? flat_normal : in_normal / max(length(in_normal), 1e-30);
  if (dot(n, flat_normal) < 0) n = -n;
  if (!(dot(n, n) > 0.5)) n = flat_normal;
  // Light comes from above the viewer's left shoulder, so that no view is against the light.
  const vec3 left = normalize(cross(vec3(0, 1, 0), towards) + vec3(1e-6, 0, 0));
  const vec3 light = normalize(0.55 * towards - 0.45 * left + vec3(0, 0.7, 0));
  const float direct = max(dot(n, light), 0), sky = 0.5 + 0.5 * n.y;
  out_colour = vec4(surface_colour() * (0.22 + 0.66 * direct + 0.14 * sky), 1);
}
