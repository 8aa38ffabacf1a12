// A scene as a model of MuJoCo: a flex for the cloth, bodies and rigid flexes for colliders.
#pragma once

#include <mujoco/mujoco.h>

#include "peer.hpp"

static_assert(sizeof(mjtNum) == 8, "the adapter needs a MuJoCo in double precision, its default");

namespace clothbench::mujoco {

using peer::Point;
using Model = std::unique_ptr<mjModel, void (*)(mjModel*)>;
using Spec = std::unique_ptr<mjSpec, void (*)(mjSpec*)>;

constexpr double kMeshRadius_m = 1e-5;  // triangles need a positive one
/// Y of an inextensible sheet. Constrained edges would be softer: at their defaults, a hanging sheet has strains
/// above 1.
constexpr double kInextensible_N_per_m = 1e4;

struct Settings {
  double contact, substeps, iterations, timestep_s, margin_m, frictionless, nominal;  // in the order of kSettings
  explicit Settings(const double* values) { std::memcpy(static_cast<void*>(this), values, sizeof *this); }
  bool passive() const { return contact > 0; }
  int steps(double dt_s) const {
    return static_cast<int>(std::max(1.0, substeps > 0 ? substeps : std::ceil(dt_s / timestep_s - 1e-9)));
  }
};

inline std::string obstacle(const Settings& settings, const ClothbenchScene& s) {
  if (mj_version() != mjVERSION_HEADER) return "the adapter was built for another version of MuJoCo";
  if (settings.contact < 0 || settings.contact > 1)
    return "setting contact: expected 0 (constraints) or 1 (passive) in MuJoCo " + std::string(mj_versionString());
  if (settings.iterations < 1 || !(settings.timestep_s > 0))
    return "expected iterations of at least 1 and timestep_s above 0";
  if (s.vertex_count > 60000) return "MuJoCo numbers bodies with 16 bits, so a cloth has at most 60000 vertices";
  if (settings.passive() && peer::needs(s, CLOTHBENCH_FRICTION) && !(settings.frictionless > 0))
    return "MuJoCo's passive contact has no friction (solver.frictionless=1 runs it without)";
  return "";
}

[[noreturn]] inline void raise(const char* text) { throw std::runtime_error("MuJoCo: " + std::string(text)); }
inline std::string name(const char* kind, std::uint32_t k) { return kind + std::to_string(k); }

/// Radius of the cloth [m]: half its thickness if it collides with itself, otherwise the scene's largest contact
/// offset.
inline double radius_m(const Settings& settings, const ClothbenchScene& s) {
  if (peer::needs(s, CLOTHBENCH_SELF_COLLISION)) return s.self_thickness_m / 2;
  double largest = kMeshRadius_m;
  for (std::uint32_t k = 0; k < s.collider_count; ++k)
    largest = std::max(largest, peer::margin(settings.margin_m, s.colliders[k]));
  return largest;
}

/// Contact offset [m]: the radius or, as a collider's margin adds to it, more. Passive contact ignores margins.
inline double offset_m(const Settings& settings, const ClothbenchScene& s, std::uint32_t k) {
  const double radius = radius_m(settings, s);
  return settings.passive() ? radius : std::max(radius, peer::margin(settings.margin_m, s.colliders[k]));
}

/// Sets material constants that give the scene's Y, 1/3 and B. Elements have Lame's constants E t / (8 (1 + nu)) and
/// E t nu / (2 (1 + nu) (1 - 2 nu)) [N/m]; strips of a grid bend with B = E t^3 / (20 (1 + nu)). `nominal`: a plate's.
inline void set_material(mjsFlex& cloth, bool nominal, double y, double b) {
  if (std::isinf(y)) y = kInextensible_N_per_m;
  cloth.poisson = nominal ? 1.0 / 3 : 1.0 / 6;
  const double e_t = nominal ? y : 3.5 * y, e_t3 = (nominal ? 12 - 12.0 / 9 : 20 + 20.0 / 6) * b;
  cloth.thickness = b > 0 ? std::sqrt(e_t3 / e_t) : 1e-3;
  cloth.young = e_t / cloth.thickness;
  cloth.elastic2d = b > 0 ? 3 : 2;
}

/// The part with the higher priority decides the friction: the collider. The types exclude pairs of colliders.
template <typename Part>
void set_contact(Part& part, double friction, int priority, int contype) {
  part.contype = contype;
  part.conaffinity = 1;
  part.priority = priority;
  part.condim = friction > 0 ? 3 : 1;
  part.friction[0] = friction;
}

/// Adds a body per vertex, free to slide along x, y, z unless pinned. In blocks, because the engine's functions that
/// add parts take time in proportion to all parts of a spec.
inline void add_vertices(mjSpec& spec, const ClothbenchScene& s, const std::vector<double>& inverse_mass,
                         mjsFlex& cloth) {
  constexpr std::uint32_t kBlock = 256;
  for (std::uint32_t first = 0; first < s.vertex_count; first += kBlock) {
    const Spec block(mj_makeSpec(), mj_deleteSpec);
    mjsBody* world = mjs_findBody(block.get(), "world");
    mjsFrame* frame = mjs_addFrame(world, nullptr);
    const std::string prefix = name("b", first / kBlock);
    for (std::uint32_t v = first; v < std::min(first + kBlock, s.vertex_count); ++v) {
      mjsBody* at = mjs_addBody(world, nullptr);
      mjs_setFrame(at->element, frame);
      mjs_setName(at->element, name("v", v).c_str());
      mjs_appendString(cloth.vertbody, (prefix + name("v", v)).c_str());
      std::copy_n(s.rest_position_m + 3 * v, 3, at->pos);
      at->explicitinertial = 1;
      at->mass = s.mass_kg[v];
      std::fill_n(at->ipos, 3, 0.0);
      std::fill_n(at->inertia, 3, 1e-4 * s.mass_kg[v]);
      for (int k = 0; k < 3 && inverse_mass[v] > 0; ++k) {
        mjsJoint* slide = mjs_addJoint(at, nullptr);
        slide->type = mjJNT_SLIDE;
        for (int i = 0; i < 3; ++i) slide->axis[i] = i == k ? 1 : 0;
      }
    }
    mjs_attach(mjs_findBody(&spec, "world")->element, frame->element, prefix.c_str(), "");
  }
}

inline void add_mesh(mjSpec& spec, const ClothbenchCollider& c, const double* vertices_m, const std::string& called,
                     double margin_m) {
  mjs_setName(mjs_addBody(mjs_findBody(&spec, "world"), nullptr)->element, called.c_str());
  mjsFlex* mesh = mjs_addFlex(&spec);
  mjs_setName(mesh->element, called.c_str());
  mjs_appendString(mesh->vertbody, called.c_str());
  mjs_setDouble(mesh->vert, vertices_m, static_cast<int>(3 * c.vertex_count));
  mjs_setInt(mesh->elem, reinterpret_cast<const int*>(c.triangles), static_cast<int>(3 * c.triangle_count));
  mesh->radius = kMeshRadius_m;
  mesh->margin = margin_m;
  set_contact(*mesh, c.friction, 1, 0);
}

/// One body per collider, as contacts are limited per pair of bodies; one mocap body per capsule. A mesh is a rigid
/// flex, because the engine replaces mesh geoms by their convex hulls.
inline void add_collider(mjSpec& spec, const ClothbenchScene& s, std::uint32_t k, double margin_m) {
  const ClothbenchCollider& c = s.colliders[k];
  const auto geom = [&](mjtGeom type, const double* at) {
    mjsBody* on = mjs_addBody(mjs_findBody(&spec, "world"), nullptr);
    on->mocap = at == nullptr;
    mjsGeom* out = mjs_addGeom(on, nullptr);
    out->type = type;
    out->margin = margin_m;
    if (at != nullptr) std::copy_n(at, 3, out->pos);
    set_contact(*out, c.friction, 1, 0);
    return out;
  };
  for (std::uint32_t n = 0; n < c.capsule_count; ++n) {
    const double* capsule = s.poses[k].capsules + 7 * n;
    mjsGeom* g = geom(mjGEOM_CAPSULE, nullptr);
    g->size[0] = capsule[6];
    g->size[1] = std::max(peer::length(peer::point(capsule, 1) - peer::point(capsule, 0)) / 2, 1e-9);
  }
  if (c.shape == CLOTHBENCH_SHAPE_SPHERE) geom(mjGEOM_SPHERE, c.center_m)->size[0] = c.radius_m;
  if (c.shape == CLOTHBENCH_SHAPE_MESH) add_mesh(spec, c, s.poses[k].vertices_m, name("m", k), margin_m);
  if (c.shape == CLOTHBENCH_SHAPE_PLANE) {
    mjsGeom* g = geom(mjGEOM_PLANE, c.center_m);
    g->size[2] = 1;  // the others stay 0: endless
    mju_quatZ2Vec(g->quat, c.normal);
  }
  if (c.shape == CLOTHBENCH_SHAPE_BOX) {
    mjsGeom* g = geom(mjGEOM_BOX, c.center_m);
    std::copy_n(c.half_extent_m, 3, g->size);
    double turn[9];
    mju_transpose(turn, c.axes, 3, 3);
    mju_mat2Quat(g->quat, turn);
  }
}

/// Bodies are in the order of vertices, after the world; the first flex is the cloth.
inline Model model(const Settings& settings, const ClothbenchScene& s, const std::vector<double>& inverse_mass) {
  mju_user_error = raise;                 // the default ends the process
  mju_user_warning = [](const char*) {};  // the default writes a file
  const Spec spec(mj_makeSpec(), mj_deleteSpec);
  const bool self = peer::needs(s, CLOTHBENCH_SELF_COLLISION), contact = self || s.collider_count > 0;
  mjsFlex* cloth = mjs_addFlex(spec.get());
  add_vertices(*spec, s, inverse_mass, *cloth);
  mjs_setInt(cloth->elem, reinterpret_cast<const int*>(s.triangles), static_cast<int>(3 * s.triangle_count));
  set_material(*cloth, settings.nominal > 0,
               s.structural_count > 0 ? s.structural_edges[0].membrane_stiffness_N_per_m : 0,
               peer::needs(s, CLOTHBENCH_BEND) ? s.bending_rigidity_N_m : 0);
  cloth->radius = radius_m(settings, s);
  cloth->passive = settings.passive() ? 1 : 0;
  cloth->selfcollide = self ? mjFLEXSELF_AUTO : mjFLEXSELF_NONE;
  set_contact(*cloth, s.self_friction, 0, 1);
  for (std::uint32_t k = 0; k < s.collider_count; ++k)
    add_collider(*spec, s, k, offset_m(settings, s, k) - cloth->radius);
  // A flex's stiffness is implicit only with this integrator and solver, which passive contact requires.
  spec->option.integrator = mjINT_IMPLICITFAST;
  spec->option.solver = mjSOL_CG;
  spec->option.iterations = static_cast<int>(settings.iterations);
  spec->option.timestep = 1 / s.frame_rate_hz / settings.steps(1 / s.frame_rate_hz);
  spec->option.disableflags |= mjDSBL_AUTORESET | (contact ? 0 : mjDSBL_CONTACT);
  std::copy_n(s.gravity_m_per_s2, 3, spec->option.gravity);
  const double n = s.vertex_count + 1000.0;  // the engine reserves room for all pairs of bodies
  spec->memory = static_cast<mjtSize>(256e6 + 2e4 * n + (contact ? 2 * n * n : 0));
  Model out(mj_compile(spec.get(), nullptr), mj_deleteModel);
  if (!out) raise(mjs_getError(spec.get()));
  return out;
}

}  // namespace clothbench::mujoco
