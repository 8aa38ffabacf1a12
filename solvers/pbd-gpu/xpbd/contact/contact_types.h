// Types that the host and the contact kernels of `xpbd` share (xpbd/contact/README.md). Included by gpu_types.h only.

/// A convex shape of a collider: the hull of `count` points, grown by `radius`.
struct ConvexShape {
  uint first, count;
  float radius, margin, friction;
  uint is_kinematic;
  uint first_source;  // index of its first point's PointSource; if static, of the next kinematic shape's
  uint unused0;
};

/// A point of a convex shape at the frame's start and end; w unused.
struct ShapePoint {
  vec4 start, end;
};

/// Box that contains a convex shape or a group of shapes throughout the frame, inflated by radius and margin.
struct ShapeAabb {
  vec4 low;  // w: maximum displacement of a point in the frame [m]
  vec4 high;
};

/// Source of point `point`, which belongs to a kinematic convex shape: vertex `index` of the kinematic meshes or, if
/// `capsule` is 1, end `index` % 2 of capsule `index` / 2.
struct PointSource {
  uint point, index, capsule;
};

/// State of one pair of a primitive of the cloth (a triangle or a vertex) and a convex shape.
struct PairState {
  vec4 normal;   // from the convex shape to the cloth; w: lower bound of the pair's distance [m]
  vec4 weights;  // of the primitive's vertices at its nearest point; w: dot(normal, shape's nearest point at the end)
  // Until plane selection: displacement of the shape's nearest point in the substep, w: target gap. Then: plane, offset
  vec4 displacement_or_plane;
  // Until plane selection: `velocity_part`, w: `depenetration`, divided by the point's inverse mass. Then: multipliers.
  vec4 correction;
};

#define PAIR_TESTED 1u   // processed by the narrow phase in this substep
#define PAIR_NEAREST 2u  // has a contact at its nearest points
#define PAIR_PLANE 4u    // has a plane
#define PAIR_LEVELS 4u   // number of kFractions

/// State of a frame's contact, on the device.
struct ContactFrameState {
  uint pairs;                        // candidate pairs in the list
  float bound_fraction;              // fraction of the vertices' motion bounds for which the list is valid
  float max_shape_displacement;      // maximum displacement of a point of any convex shape in the frame [m]
  uint active_pair_count[2];         // pairs active in this substep, before and after the constraint solve
  uint cloth_low[3], cloth_high[3];  // box of all positions that the cloth can reach, as integers of ordered()
  uint self_list_expired;            // 1: this substep makes a new list of self-contact pairs
  uint self_listed[2];               // pairs of a new list by SelfAabb: _1; _0 if those do not fit
  uint self_list_one_substep;        // 1: the list is of the second kind, for one substep
  uint self_active;                  // self-contact pairs active in this substep
  uint self_contact_pairs;           // active self-contact pairs that have contacts
  uint self_contacts;                // their contacts
  uint touched_vertices;             // vertices with pairs of their own or of their triangles
  uint contact_free;          // 1: the frame was simulated without contact (contact_free_frame.glsl, fused_frame.comp)
  uint contact_possible;      // 1: a pair is active, or a shape is within reach of the cloth's contact-free motion
  uint max_displacement;      // max over vertices [m], bits of a float; before its reset, of the last frame
  uint max_strain;            // max over links at the list's end, bits of a float
  uint measured;              // workgroups of MEASURE that have finished
  uint counted[PAIR_LEVELS];  // pairs at each of kFractions of the motion bounds
  float last_h;               // length of the last substep in a fused frame [s]; 0: none
};

#define BROAD_PHASE_DONE 1u  // LineConstants::first_pass if an earlier dispatch has made the frame's list; otherwise 0

/// Boxes of a cloth triangle, or of a group of them: of the positions at the start of the substep that makes the list
/// (_0), and of all positions while the list is valid, with room for contact corrections (_1).
struct SelfAabb {
  vec4 low_0;                  // w: largest limit of the vertices' displacements in that substep [m]
  vec4 high_0, low_1, high_1;  // w unused
};

/// Box of GROUPS_PER_SUPERGROUP successive groups of triangles, as integers of ordered().
struct SelfSupergroup {
  uint low[3], high[3];
};

/// Box within which a vertex may begin and propose to end a substep while the list of self-contact pairs is valid.
struct SelfBounds {
  vec4 low, high;  // w unused
};

/// A candidate pair of cloth triangles. Each of the two triangles has an entry, which names the other one.
struct SelfPair {
  uint other;
  float bound;  // lower bound of their distance [m]
};

/// A pair of triangles that is active in this substep. Like a SelfPair, it is stored with each of the two.
struct SelfActivePair {
  uint own, other;
  uint link;             // index of its SelfPair; after the narrow phase, of its corrections
  uint marks;            // bit mask of its contacts, and SELF_PLANE if it has a plane
  vec4 plane;            // normal, towards the own triangle; w: offset
  float multipliers[3];  // of the own triangle's vertices
  uint first_contact;
};

/// One of an active pair's up to SELF_CONTACTS contacts, stored one after another. 0: nearest points of the two
/// triangles; 1 to 3: the first triangle's vertices with the second; 4 to 6: the second's vertices with the first. The
/// first triangle has the lower index.
struct SelfContact {
  vec4 normal;   // towards the first triangle; w: distance to keep [m]
  vec4 weights;  // of the first triangle's first two vertices at the nearest point, then of the second's; sums are 1
};
#define SELF_CONTACTS 7u
#define CONTACTS_PER_PAIR 2u  // in the list; on average a pair has fewer
#define SELF_PLANE 128u

/// Corrections that the contacts of an active pair propose for a vertex, as a sum weighted by length.
struct SelfCorrection {
  vec4 all;            // w: sum of lengths
  vec4 velocity_part;  // part of the sum that also changes velocity
};

/// A link between two vertices, and its length at rest.
struct StructuralLink {
  uint a, b;
  float rest_m;
};

/// Counts since loading or reset (0 unless contact failed), and what sets the next frame's substeps.
struct ContactDiagnostics {
  uint infeasible_vertices;  // vertices without a feasible position at a substep's end
  uint inside;               // pairs that touch at a substep's start
  uint overflow;             // pairs beyond the list's capacity
  uint max_displacement;     // maximum displacement of a vertex in the last frame [m], the bits of a float
  uint max_strain;           // maximum strain of a link in the last frame, the bits of a float
};

/// Push constants of the kernels of contact.
struct ContactConstants {
  vec4 gravity_h;                // g h [m/s]
  uint response_round;           // 0: before the constraint solve, at predicted positions; from 1 on: after it
  uint first_substep, substeps;  // index of this substep; substeps per frame
  uint level;                    // index into kFractions; of self_listed
  float substep_part;            // 1 / substeps
  float h, per_h;                // of the substep [s], [1/s]
  float damping_fraction;        // 1 - exp(-c h)
  float frame_s;
  float bound_m;  // maximum of bound_at_rest(): at most half a cell, and the fall in a frame
};
#define SHAPES_PER_GROUP 16u
#define TRIANGLES_PER_GROUP 32u  // in self-contact
#define GROUPS_PER_SUPERGROUP 32u
