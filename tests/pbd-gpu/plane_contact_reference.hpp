#pragma once
#include <Eigen/Dense>
#include <array>
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench::pbd_gpu {

/// Contact by planes in double on the CPU, phase by phase as PLANES.md has it and by brute force: every element against
/// every piece and triangle against triangle, no boxes, no lists, and the nearest point of a hull over every three of
/// its points. Cloth that nothing holds together, so that contact alone is seen.
class PlaneContactReference {
 public:
  PlaneContactReference(const Scene& scene, int substeps);
  /// The frame from scene.motion[index] to the next.
  void frame(int index);

  std::vector<Eigen::Vector3d> x, v;  ///< positions [m] and velocities [m/s], one a vertex
  long responses = 0, self_responses = 0, projected = 0, without_place = 0;

 private:
  using V = Eigen::Vector3d;
  using Points = std::vector<V>;
  struct Piece {
    Points first, last;  ///< at the frame's start and end
    Points start, end;   ///< of the substep
    double radius = 0, margin = 0, friction = 0;
    bool moves = false;
    double displacement() const;  ///< greatest of any point in the frame
  };
  /// Where an element and a piece are nearest: direction to the cloth, certified gap, weights of the element's
  /// vertices, and the piece's point at the substep's end with its displacement.
  struct Nearest {
    V n = V::Zero(), on_cloth = V::Zero(), witness = V::Zero(), way = V::Zero();
    double gap = -1e30;
  };
  struct Pair {
    std::size_t piece;
    bool contact = false, plane = false;
    Nearest nearest;
    double target = 0, offset = 0;
    V push = V::Zero();
    double out_by = 0;  ///< part of the correction that is no velocity
    std::array<double, 3> multipliers{};
  };
  struct Element {
    std::vector<std::size_t> vertices;
    std::vector<Pair> pairs;
  };
  /// Two triangles of the cloth without a common vertex, or a vertex and a triangle: the contact alone.
  struct SelfContact {
    std::vector<std::size_t> first, second;  ///< vertices
    Nearest nearest;                         ///< direction to the first
    V on_second = V::Zero();                 ///< weights
    double target = 0;
    bool near = false;
  };
  struct SelfPlane {
    V n;
    double offset;
    double multiplier = 0;
  };
  struct Wish {
    V moving, out;
  };
  struct Half {
    V n;
    double offset, margin, friction;
  };

  void place_pieces(int index);
  void place_mesh(std::size_t collider, const ColliderPose& begin, const ColliderPose& end);
  void substep(int s);
  void query(Element& e);
  bool parted_by_face(const Element& e, Pair& pair) const;
  Nearest nearest(const Points& cloth, const Points& piece, const Points& end) const;
  double kept_margin(const Element& e, const Pair& pair) const;
  void make_self_contacts();
  void query_self(const std::vector<double>& room);
  void query_self(SelfContact& s, const std::vector<double>& room) const;
  void wish_self(int round);
  void wish_of(const SelfContact& s, int round);
  void choose_self();
  void respond(bool before, int round);
  void push_of(const Element& e, Pair& pair, int round) const;
  void choose(const Element& e, Pair& pair) const;
  V place(std::size_t i, double room);
  V projected_on_planes(std::size_t i, V at);
  double offset_of(const Half& h, std::size_t i) const;
  double worst(std::size_t i, const V& at) const;
  template <class Fn>
  void each_plane(std::size_t i, Fn fn);

  const Scene& scene_;
  const int substeps_;
  double h_ = 0, least_margin_ = 0, most_margin_ = 0, thickness_ = 0;
  std::vector<double> w_;
  std::vector<V> y_, x0_;
  std::vector<Piece> pieces_;
  std::vector<Half> halves_;
  std::vector<Element> elements_;
  std::vector<SelfContact> self_;               ///< triangles with triangles, then vertices with triangles
  std::size_t self_pairs_ = 0;                  ///< of triangles
  std::vector<std::vector<Wish>> self_wishes_;  ///< of each vertex
  std::vector<std::vector<SelfPlane>> self_planes_;
  std::vector<std::vector<std::pair<std::size_t, std::size_t>>> fans_;  ///< triangle and corner, of each vertex
};

}  // namespace clothbench::pbd_gpu
