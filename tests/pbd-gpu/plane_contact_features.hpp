#pragma once
#include <Eigen/Dense>
#include <vector>

namespace clothbench::pbd_gpu {

/// Nearest points of two features, as weights of all points of both sides.
struct Closest {
  double square = 1e30;
  Eigen::VectorXd on_cloth, on_piece;
};

/// Feet of points on segments and faces and of segments on each other, of every two or three points of a side: the
/// nearest of them are the nearest points of two convex hulls that do not meet.
class Features {
  using V = Eigen::Vector3d;
  using Points = std::vector<V>;

 public:
  Features(const Points& cloth, const Points& piece) : cloth_(cloth), piece_(piece) {}

  Closest closest() {
    const std::size_t n = cloth_.size(), m = piece_.size();
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < m; ++j) {
        put(one(n, i), one(m, j));
        for (std::size_t i2 = i + 1; i2 < n; ++i2) {
          foot_on_segment(piece_[j], cloth_[i], cloth_[i2], [&](double t) { put(two(n, i, i2, t), one(m, j)); });
          for (std::size_t j2 = j + 1; j2 < m; ++j2) segments(i, i2, j, j2);
        }
        for (std::size_t j2 = j + 1; j2 < m; ++j2) {
          foot_on_segment(cloth_[i], piece_[j], piece_[j2], [&](double t) { put(one(n, i), two(m, j, j2, t)); });
          for (std::size_t j3 = j2 + 1; j3 < m; ++j3)
            foot_on_face(cloth_[i], piece_[j], piece_[j2], piece_[j3],
                         [&](const V& l) { put(one(n, i), three(m, j, j2, j3, l)); });
        }
      }
    if (n == 3)
      for (std::size_t j = 0; j < m; ++j)
        foot_on_face(piece_[j], cloth_[0], cloth_[1], cloth_[2],
                     [&](const V& l) { put(three(3, 0, 1, 2, l), one(m, j)); });
    return best_;
  }

 private:
  static Eigen::VectorXd one(std::size_t n, std::size_t i) {
    return Eigen::VectorXd::Unit(Eigen::Index(n), Eigen::Index(i));
  }
  static Eigen::VectorXd two(std::size_t n, std::size_t i, std::size_t j, double t) {
    return (1 - t) * one(n, i) + t * one(n, j);
  }
  static Eigen::VectorXd three(std::size_t n, std::size_t i, std::size_t j, std::size_t k, const V& l) {
    return l[0] * one(n, i) + l[1] * one(n, j) + l[2] * one(n, k);
  }
  static V at(const Points& points, const Eigen::VectorXd& weights) {
    V sum = V::Zero();
    for (std::size_t k = 0; k < points.size(); ++k) sum += weights[Eigen::Index(k)] * points[k];
    return sum;
  }
  void put(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
    const double square = (at(cloth_, a) - at(piece_, b)).squaredNorm();
    if (square < best_.square) best_ = {square, a, b};
  }
  template <class Fn>
  static void foot_on_segment(const V& p, const V& a, const V& b, Fn fn) {
    const double t = (p - a).dot(b - a) / (b - a).squaredNorm();
    if (t > 0 && t < 1) fn(t);
  }
  template <class Fn>
  static void foot_on_face(const V& p, const V& a, const V& b, const V& c, Fn fn) {
    const V n = (b - a).cross(c - a);
    const V l =
        V((b - p).cross(c - p).dot(n), (c - p).cross(a - p).dot(n), (a - p).cross(b - p).dot(n)) / n.squaredNorm();
    if (l.minCoeff() > 0) fn(l);
  }
  void segments(std::size_t i, std::size_t i2, std::size_t j, std::size_t j2) {
    const V e = cloth_[i2] - cloth_[i], f = piece_[j2] - piece_[j], g = cloth_[i] - piece_[j];
    const double ee = e.dot(e), ff = f.dot(f), ef = e.dot(f), all = ee * ff - ef * ef;
    if (!(all > 1e-12 * ee * ff)) return;  // parallel: an end is as near
    const double s = (ef * f.dot(g) - ff * e.dot(g)) / all, t = (ee * f.dot(g) - ef * e.dot(g)) / all;
    if (s > 0 && s < 1 && t > 0 && t < 1) put(two(cloth_.size(), i, i2, s), two(piece_.size(), j, j2, t));
  }

  const Points &cloth_, &piece_;
  Closest best_;
};

}  // namespace clothbench::pbd_gpu
