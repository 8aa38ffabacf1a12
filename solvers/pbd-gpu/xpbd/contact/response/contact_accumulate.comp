#version 450
// End of a response round: vertices take the mean of their corrections. A cluster of lanes per vertex.
#define SUBGROUPS
#include "xpbd/contact/contact_buffers.glsl"
#include "xpbd/contact/subgroup_cluster.glsl"
#include "xpbd/contact/response/friction.glsl"
#include "xpbd/contact/response/contact_accumulate.glsl"

void main() {
  response_round = p.response_round;
  accumulate_all(item(), stride());
}
