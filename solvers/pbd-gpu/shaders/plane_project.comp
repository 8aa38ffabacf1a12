#version 450
// A substep's end, a thread a vertex; SHUFFLES: a team of lanes.
#define SUBGROUPS
#include "common.glsl"
#include "plane_buffers.glsl"
#include "plane_team.glsl"
#include "plane_project.glsl"

void main() {
  begin_substep(p.first_substep);
  project_all(item(), stride());
  if (item() == 0u) ledger.asked[1] = ledger.self_near = ledger.self_touching = 0u;  // for the next substep
}
