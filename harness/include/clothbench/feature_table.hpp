// Every feature is a row here and a bit in clothbench_plugin.h, in the same order. Before including this table, a
// file must define the macro FEATURE with these arguments:
//   enumerator, name in files, suffix of the plugin's bit CLOTHBENCH_<suffix>, category (FeatureOf), description,
//   expression that is true if `scene` needs the feature (it may use helpers of harness/scenario/load.cpp).

FEATURE(Stretch, stretch, STRETCH, Cloth, "stretch along the edges of the grid or mesh", true)
FEATURE(Shear, shear, SHEAR, Cloth, "shear, along the diagonals of a grid", scene.material.shear && !scene.cloth.mesh)
FEATURE(Bend, bend, BEND, Cloth, "resistance to bending", scene.material.bending_rigidity_N_m > 0)
FEATURE(Damping, damping, DAMPING, Cloth, "mass-proportional damping", scene.material.damping_per_s > 0)
FEATURE(Pins, pins, PINS, Cloth, "fixed vertices", !scene.pins.vertices.empty())
FEATURE(MovingPins, moving_pins, MOVING_PINS, Cloth, "attachments: vertices that hands or bars move",
        !scene.grips.vertices.empty())
FEATURE(Sphere, sphere, SPHERE, Collider, "a static sphere", touches(scene, Feature::Sphere))
FEATURE(Box, box, BOX, Collider, "a static box", touches(scene, Feature::Box))
FEATURE(Plane, plane, PLANE, Collider, "a half-space", touches(scene, Feature::Plane))
FEATURE(Capsules, capsules, CAPSULES, Collider, "kinematic capsules, also as a hand", touches(scene, Feature::Capsules))
FEATURE(StaticMesh, static_mesh, STATIC_MESH, Collider, "a static mesh", touches(scene, Feature::StaticMesh))
FEATURE(MovingMesh, moving_mesh, MOVING_MESH, Collider, "a kinematic skinned mesh, such as a hand",
        touches(scene, Feature::MovingMesh))
FEATURE(Friction, friction, FRICTION, Cloth, "Coulomb friction, on colliders or between layers of the cloth",
        rubs(scene))
// Two-sided contact also needs colliders, because a scene without colliders has no contact.
FEATURE(DoubleSided, double_sided, DOUBLE_SIDED, Cloth, "contact on both faces without a duplicated layer",
        scene.cloth.sides == Sides::Double && !scene.colliders.empty())
FEATURE(DuplicatedLayer, duplicated_layer, DUPLICATED_LAYER, Cloth,
        "contact on both faces by a second, oppositely wound layer of vertices tied to the first",
        scene.cloth.sides == Sides::DoubleDuplicated)
FEATURE(SelfCollision, self_collision, SELF_COLLISION, Cloth, "contact of the cloth with itself",
        scene.cloth.self_collision.thickness_m > 0)
FEATURE(UnevenGrid, uneven_grid, UNEVEN_GRID, Data, "cells of different widths (cloth.column_factors)",
        !scene.cloth.column_factors.empty())
FEATURE(Regions, regions, REGIONS, Data,
        "different membrane stiffness in columns of a grid or groups of a mesh (material.regions)",
        !scene.material.regions.empty())
FEATURE(Spin, spin, SPIN, Data, "an initial rotation (cloth.spin_rad_per_s)", scene.cloth.spin_rad_per_s != Vec3{})
FEATURE(ClothMesh, cloth_mesh, CLOTH_MESH, Data, "a triangle mesh instead of a grid (cloth.mesh)",
        scene.cloth.mesh != nullptr)
