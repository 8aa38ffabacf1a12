// Part of gpu_types.h, which includes it: what the host and the kernels of contact by separating planes share.

// Contact of `xpbd`: xpbd/contact/README.md.

/// A convex shape of a collider: the hull of `count` points, grown by `radius`.
struct ConvexShape {
  uint first, count;
  float radius, margin, friction;
  uint is_kinematic;
  uint first_source;  // of its points if it moves; else of the next convex shape that does
  uint unused0;
};

/// A point of a convex shape at the frame's start and end; w unused.
struct ShapePoint {
  vec4 start, end;
};

/// Box around a convex shape or a group of shapes: its displacement through the frame, its radius and its margin.
struct ShapeAabb {
  vec4 low;  // w: maximum displacement of any of their points in the frame
  vec4 high;
};

/// Where a point of a kinematic convex shape comes from: vertex `index` of the kinematic meshes, or end `index` % 2 of
/// capsule `index` / 2 if `capsule` is 1.
struct PointSource {
  uint point, index, capsule;
};

/// State of one pair of a primitive of the cloth (a triangle or a vertex) and a convex shape.
struct PairState {
  vec4 normal;   // from the convex shape to the cloth; w: lower bound of the pair's distance [m]
  vec4 weights;  // of the primitive's vertices at its nearest point; w: dot(normal, shape's nearest point at the end)
  // First the displacement of the shape's nearest point in the substep; w: target gap. Then the plane; w: offset.
  vec4 displacement_or_plane;
  // First `velocity_part` over the point's inverse mass; w: `depenetration` over it. Then multipliers.
  vec4 correction;
};

#define PAIR_TESTED 1u   // near enough to be processed in this substep
#define PAIR_NEAREST 2u  // has a contact at its nearest points
#define PAIR_PLANE 4u    // has a plane
#define PAIR_LEVELS 4u   // motion bounds tried: kFractions of them

/// State of the frame, on the device.
struct ContactFrameState {
  uint pairs;                        // in the list
  float bound_fraction;              // fraction of the vertices' motion bounds that the list is made for
  float max_shape_displacement;      // maximum displacement of a point of any convex shape in the frame [m]
  uint active_pair_count[2];         // pairs active in this substep, before and after the lines
  uint cloth_low[3], cloth_high[3];  // box that the cloth may be in, in the order of atomic_aabb.glsl
  float self_bound_fraction;         // as motion bound, of the list of self-contact pairs
  uint self_active;                  // its pairs active in this substep
  uint self_contact_pairs;           // active self-contact pairs that have contacts
  uint touched_vertices;             // vertices with pairs of their own or of their triangles
  uint contact_free;      // 1: the frame was done without contact (contact_free_frame.glsl, fused_frame.comp)
  uint contact_possible;  // 1: the cloth may touch a convex shape in this frame, or might if it had no contact
  uint max_displacement;  // of a vertex in this frame [m], a float's bits; until its list is made, in the last one
  uint counted[PAIR_LEVELS], self_counted[PAIR_LEVELS];  // pairs of the lists at each fraction of the motion bounds
  float drift[3];  // velocity [m/s] that the list of self-contact pairs moves along with: half the mean
};

#define BROAD_PHASE_DONE 1u  // LineConstants::first_pass where a dispatch before has made the frame's list; else 0

/// Boxes of a triangle of the cloth, larger by half of the thickness: at rest, and grown by its vertices' motion
/// bounds.
struct SelfAabb {
  vec4 low_0, high_0, low_1, high_1;  // w unused
};

/// A pair of triangles of the cloth, listed with each of the two.
struct SelfPair {
  uint other;
  float bound;  // lower bound of their distance [m]
};

/// A pair of triangles that is active in this substep, as one of the two has it.
struct SelfActivePair {
  uint own, other;
  uint link;         // its SelfPair; once asked, where its contacts are
  uint marks;        // bit mask of its contacts, and SELF_PLANE if it has a plane
  vec4 plane;        // normal, towards the own triangle; w: offset
  vec4 multipliers;  // of the own triangle's vertices
};

/// Contacts of an active pair: the nearest points of the two triangles, then each vertex of the one and the other
/// triangle, with the triangle of the lower number first.
struct SelfContact {
  vec4 normal;         // towards the first triangle; w: distance to keep [m]
  vec4 first, second;  // weights of the vertices at the nearest points; w unused
};
#define SELF_CONTACTS 7u
#define SELF_PLANE 128u

/// Correction that an active pair proposes for a vertex: sums weighted by length.
struct SelfCorrection {
  vec4 all;            // w: sum of lengths
  vec4 velocity_part;  // its part that is velocity
};

/// Counts since loading or reset; all are 0 unless contact failed. And what the next frame's substeps depend on.
struct ContactDiagnostics {
  uint infeasible_vertices;  // vertices that were not before all their planes at a substep's end
  uint inside;               // pairs that touch at a substep's start
  uint overflow;             // pairs that the list had no place for
  uint max_displacement;     // maximum displacement of a vertex in the last frame [m], the bits of a float
};

/// Push constants of the kernels of contact.
struct ContactConstants {
  vec4 gravity_h;                // g h [m/s]
  uint response_round;           // of responses: 0 before the lines, with the predicted positions; 1 and on after them
  uint first_substep, substeps;  // this substep; substeps of the frame
  uint level;                    // fraction of the motion bounds, kFractions
  float substep_part;            // of the frame
  float h, per_h;                // of the substep [s], [1/s]
  float damping_fraction;        // 1 - exp(-c h)
  float frame_s;
  float bound_m;  // of a vertex at rest
};
#define SHAPES_PER_GROUP 16u
