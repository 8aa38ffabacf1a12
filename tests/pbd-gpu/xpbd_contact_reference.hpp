#pragma once
#include <Eigen/Dense>
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench::pbd_gpu {

/// Contact of `xpbd` in double on the CPU, from the README's description and by brute force: every triangle, no boxes.
/// Cloth that nothing holds together, so that contact alone is seen. Vertices and samples as in the solver.
class ContactReference {
 public:
  ContactReference(const Scene& scene, int substeps, int samples);
  /// The frame from scene.motion[index] to the next.
  void frame(int index);

  std::vector<Eigen::Vector3d> x, v;
  long active_contacts = 0;  ///< contacts, so that a test can tell that there were some

 private:
  using V = Eigen::Vector3d;
  struct Piece {
    double distance;
    V normal, delta;  // delta: way in the whole frame
    double margin, friction;
  };
  struct Found {
    Piece nearest, other;
    bool has_other;
    double free_share;
  };
  struct Way {
    V at, left;
    double now, part;  // fractions of the frame
  };

  std::vector<Piece> pieces(const V& at, double now) const;
  void add_shape(const Collider& c, std::size_t index, const V& at, double now, std::vector<Piece>& all) const;
  void add_mesh(std::size_t index, const V& at, double now, std::vector<Piece>& all) const;
  Found look(const Way& way, const V& active_normal) const;
  void respond_to(const Piece& piece, Way& way, V& velocity);
  V advance(const V& from, const V& to, double begin, V& velocity, bool& touched);
  void substep(int s);

  const Scene& scene_;
  const int substeps_, samples_;
  int frame_ = 0;
  std::vector<double> w_;
  std::vector<V> side_, sample_side_;
  std::vector<std::vector<double>> mesh_start_, mesh_end_;  // by collider
  std::vector<std::vector<std::uint32_t>> marks_;
  bool sampling_ = false;  // the point asked about is a sample
  double least_margin_, border_margin_;
};

}  // namespace clothbench::pbd_gpu
