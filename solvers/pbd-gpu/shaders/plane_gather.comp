#version 450
// A round's end, a thread a vertex; SHUFFLES: a team of lanes.
#define SUBGROUPS
#include "common.glsl"
#include "plane_buffers.glsl"
#include "plane_team.glsl"
#include "friction.glsl"
#include "plane_gather.glsl"

void main() {
  turn = p.turn;
  gather_all(item(), stride());
}
