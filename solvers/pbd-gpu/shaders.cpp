#include "shaders.hpp"

namespace clothbench::pbd_gpu {
namespace {

#define CODE(id) const std::uint32_t id[] = {
CODE(apply_external_forces)
#include "apply_external_forces.inc"
};
CODE(apply_external_forces_counted)
#include "apply_external_forces_counted.inc"
};
CODE(damp_velocities)
#include "damp_velocities.inc"
}
;
CODE(damp_velocities_counted)
#include "damp_velocities_counted.inc"
}
;
CODE(apply_explicit_euler)
#include "apply_explicit_euler.inc"
}
;
CODE(apply_explicit_euler_counted)
#include "apply_explicit_euler_counted.inc"
}
;
CODE(project_constraint_deltas)
#include "project_constraint_deltas.inc"
}
;
CODE(project_constraint_deltas_counted)
#include "project_constraint_deltas_counted.inc"
}
;
CODE(project_constraint_deltas_native)
#include "project_constraint_deltas_native.inc"
}
;
CODE(project_constraint_deltas_native_counted)
#include "project_constraint_deltas_native_counted.inc"
}
;
CODE(average_constraint_deltas)
#include "average_constraint_deltas.inc"
}
;
CODE(average_constraint_deltas_counted)
#include "average_constraint_deltas_counted.inc"
}
;
CODE(update_positions)
#include "update_positions.inc"
}
;
CODE(update_positions_counted)
#include "update_positions_counted.inc"
}
;

CODE(skin_mesh)
#include "skin_mesh.inc"
}
;
CODE(skin_mesh_counted)
#include "skin_mesh_counted.inc"
}
;
CODE(skin_mesh_keep_start)
#include "skin_mesh_keep_start.inc"
}
;
CODE(skin_mesh_keep_start_counted)
#include "skin_mesh_keep_start_counted.inc"
}
;
CODE(move_grips)
#include "move_grips.inc"
}
;
CODE(move_grips_counted)
#include "move_grips_counted.inc"
}
;
CODE(satisfy_sphere_collisions)
#include "satisfy_sphere_collisions.inc"
}
;
CODE(satisfy_sphere_collisions_counted)
#include "satisfy_sphere_collisions_counted.inc"
}
;
CODE(satisfy_cube_collisions)
#include "satisfy_cube_collisions.inc"
}
;
CODE(satisfy_cube_collisions_counted)
#include "satisfy_cube_collisions_counted.inc"
}
;
CODE(satisfy_capsule_collisions)
#include "satisfy_capsule_collisions.inc"
}
;
CODE(satisfy_capsule_collisions_counted)
#include "satisfy_capsule_collisions_counted.inc"
}
;
CODE(satisfy_mesh_collisions)
#include "satisfy_mesh_collisions.inc"
}
;
CODE(satisfy_mesh_collisions_counted)
#include "satisfy_mesh_collisions_counted.inc"
}
;

CODE(contact_boxes)
#include "contact_boxes.inc"
}
;
CODE(contact_boxes_counted)
#include "contact_boxes_counted.inc"
}
;
CODE(contact_candidates)
#include "contact_candidates.inc"
}
;
CODE(contact_candidates_shuffle)
#include "contact_candidates_shuffle.inc"
}
;
CODE(contact_candidates_counted)
#include "contact_candidates_counted.inc"
}
;
CODE(contact_samples)
#include "contact_samples.inc"
}
;
CODE(contact_samples_shuffle)
#include "contact_samples_shuffle.inc"
}
;
CODE(contact_samples_counted)
#include "contact_samples_counted.inc"
}
;
CODE(contact_samples_mesh)
#include "contact_samples_mesh.inc"
}
;
CODE(contact_samples_mesh_shuffle)
#include "contact_samples_mesh_shuffle.inc"
}
;
CODE(contact_samples_mesh_counted)
#include "contact_samples_mesh_counted.inc"
}
;
CODE(contact_vertices)
#include "contact_vertices.inc"
}
;
CODE(contact_vertices_shuffle)
#include "contact_vertices_shuffle.inc"
}
;
CODE(contact_vertices_counted)
#include "contact_vertices_counted.inc"
}
;
CODE(contact_vertices_mesh)
#include "contact_vertices_mesh.inc"
}
;
CODE(contact_vertices_mesh_shuffle)
#include "contact_vertices_mesh_shuffle.inc"
}
;
CODE(contact_vertices_mesh_counted)
#include "contact_vertices_mesh_counted.inc"
}
;

CODE(self_blocks)
#include "self_blocks.inc"
}
;
CODE(self_blocks_counted)
#include "self_blocks_counted.inc"
}
;
CODE(self_near)
#include "self_near.inc"
}
;
CODE(self_near_counted)
#include "self_near_counted.inc"
}
;
CODE(self_wishes)
#include "self_wishes.inc"
}
;
CODE(self_wishes_counted)
#include "self_wishes_counted.inc"
}
;
CODE(self_apply)
#include "self_apply.inc"
}
;
CODE(self_apply_counted)
#include "self_apply_counted.inc"
}
;
CODE(self_certify)
#include "self_certify.inc"
}
;
CODE(self_certify_counted)
#include "self_certify_counted.inc"
}
;
CODE(self_move)
#include "self_move.inc"
}
;
CODE(self_move_counted)
#include "self_move_counted.inc"
}
;

CODE(line_frame)
#include "line_frame.inc"
}
;
CODE(line_frame_counted)
#include "line_frame_counted.inc"
}
;
CODE(line_frame_shuffle)
#include "line_frame_shuffle.inc"
}
;
CODE(line_frame_shuffle_counted)
#include "line_frame_shuffle_counted.inc"
}
;
CODE(line_frame_keep)
#include "line_frame_keep.inc"
}
;
CODE(line_frame_keep_counted)
#include "line_frame_keep_counted.inc"
}
;
CODE(line_frame_shuffle_keep)
#include "line_frame_shuffle_keep.inc"
}
;
CODE(line_frame_shuffle_keep_counted)
#include "line_frame_shuffle_keep_counted.inc"
}
;
CODE(line_pass)
#include "line_pass.inc"
}
;
CODE(line_pass_counted)
#include "line_pass_counted.inc"
}
;
CODE(line_pass_shuffle)
#include "line_pass_shuffle.inc"
}
;
CODE(line_pass_shuffle_counted)
#include "line_pass_shuffle_counted.inc"
}
;
CODE(line_pass_keep)
#include "line_pass_keep.inc"
}
;
CODE(line_pass_keep_counted)
#include "line_pass_keep_counted.inc"
}
;
CODE(line_pass_shuffle_keep)
#include "line_pass_shuffle_keep.inc"
}
;
CODE(line_pass_shuffle_keep_counted)
#include "line_pass_shuffle_keep_counted.inc"
}
;

CODE(line_pass_resident)
#include "line_pass_resident.inc"
}
;
CODE(line_pass_resident_counted)
#include "line_pass_resident_counted.inc"
}
;
CODE(line_pass_resident_keep)
#include "line_pass_resident_keep.inc"
}
;
CODE(line_pass_resident_keep_counted)
#include "line_pass_resident_keep_counted.inc"
}
;

CODE(chain_pass_resident)
#include "chain_pass_resident.inc"
}
;
CODE(chain_pass_resident_counted)
#include "chain_pass_resident_counted.inc"
}
;
CODE(weld)
#include "weld.inc"
}
;
CODE(weld_counted)
#include "weld_counted.inc"
}
;
CODE(chain_pass)
#include "chain_pass.inc"
}
;
CODE(chain_pass_counted)
#include "chain_pass_counted.inc"
}
;

}  // namespace

namespace shaders {
#define CODES(id) {#id, {id, sizeof id}, {id##_counted, sizeof id##_counted}}
#define SHADER(constant, id) const Shader constant = CODES(id)
SHADER(kApplyExternalForces, apply_external_forces);
SHADER(kDampVelocities, damp_velocities);
SHADER(kApplyExplicitEuler, apply_explicit_euler);
SHADER(kProjectConstraintDeltas, project_constraint_deltas);
SHADER(kProjectConstraintDeltasNative, project_constraint_deltas_native);
SHADER(kAverageConstraintDeltas, average_constraint_deltas);
SHADER(kUpdatePositions, update_positions);
SHADER(kSkinMesh, skin_mesh);
SHADER(kSkinMeshKeepStart, skin_mesh_keep_start);
SHADER(kMoveGrips, move_grips);
SHADER(kSatisfySphereCollisions, satisfy_sphere_collisions);
SHADER(kSatisfyCubeCollisions, satisfy_cube_collisions);
SHADER(kSatisfyCapsuleCollisions, satisfy_capsule_collisions);
SHADER(kSatisfyMeshCollisions, satisfy_mesh_collisions);
SHADER(kContactBoxes, contact_boxes);
SHADER(kChainPass, chain_pass);
SHADER(kChainsResident, chain_pass_resident);
SHADER(kWeld, weld);
SHADER(kSelfBlocks, self_blocks);
SHADER(kSelfNear, self_near);
SHADER(kSelfWishes, self_wishes);
SHADER(kSelfApply, self_apply);
SHADER(kSelfCertify, self_certify);
SHADER(kSelfMove, self_move);
// Bytes are counted without shuffles: what lanes load together counts once.
#define SHUFFLED(id) {#id "_shuffle", {id##_shuffle, sizeof id##_shuffle}, {id##_counted, sizeof id##_counted}}
const Shader kContactCandidates[2] = {CODES(contact_candidates), SHUFFLED(contact_candidates)};
const Shader kContactSamples[2][2] = {{CODES(contact_samples), SHUFFLED(contact_samples)},
                                      {CODES(contact_samples_mesh), SHUFFLED(contact_samples_mesh)}};
const Shader kContactVertices[2][2] = {{CODES(contact_vertices), SHUFFLED(contact_vertices)},
                                       {CODES(contact_vertices_mesh), SHUFFLED(contact_vertices_mesh)}};
#define LINES(constant, id) \
  const Shader constant[2][2] = {{CODES(id), CODES(id##_keep)}, {CODES(id##_shuffle), CODES(id##_shuffle_keep)}}
LINES(kLineFrame, line_frame);
LINES(kLinePass, line_pass);
const Shader kLinesResident[2] = {CODES(line_pass_resident), CODES(line_pass_resident_keep)};
}  // namespace shaders

}  // namespace clothbench::pbd_gpu
