// The cloth's contact with itself by planes, in double and over all pairs.
#include <algorithm>

#include "plane_contact_reference.hpp"

namespace clothbench::pbd_gpu {
namespace {

constexpr double kGuard = 2e-4, kRecovered = 0.1;

}  // namespace

void PlaneContactReference::make_self_contacts() {
  const std::size_t triangles = elements_.size() - x.size();
  const auto has = [&](std::size_t triangle, std::size_t v) {
    const auto& all = elements_[triangle].vertices;
    return std::find(all.begin(), all.end(), v) != all.end();
  };
  const auto joined = [&](std::size_t a, std::size_t b) {
    const auto& all = elements_[a].vertices;
    return std::any_of(all.begin(), all.end(), [&](std::size_t v) { return has(b, v); });
  };
  for (std::size_t a = 0; a < triangles; ++a)
    for (std::size_t b = a + 1; b < triangles; ++b)
      if (!joined(a, b)) self_.push_back({elements_[a].vertices, elements_[b].vertices, {}, V::Zero(), 0, false});
  self_pairs_ = self_.size();
  // A vertex and a triangle that has no vertex of some triangle of its own.
  for (std::size_t v = 0; v < x.size(); ++v)
    for (std::size_t t = 0; t < triangles; ++t)
      if (std::any_of(fans_[v].begin(), fans_[v].end(), [&](const auto& fan) { return !joined(fan.first, t); }))
        self_.push_back({{v}, elements_[t].vertices, {}, V::Zero(), 0, false});
}

void PlaneContactReference::query_self(SelfContact& s, const std::vector<double>& room) const {
  Points first, second;
  double most_first = 0, most_second = 0, square = 0;
  for (const std::size_t i : s.first) first.push_back(x0_[i]), most_first = std::max(most_first, room[i]);
  for (const std::size_t i : s.second) second.push_back(x0_[i]), most_second = std::max(most_second, room[i]);
  // A bound that is quick: of the first vertices, less both sides' lengths.
  for (const Points* side : {&first, &second})
    for (const V& at : *side) square = std::max(square, (at - side->front()).norm());
  s.near = false;
  if ((first[0] - second[0]).norm() - 2 * square > most_first + most_second) return;
  s.nearest = nearest(first, second, second);
  s.on_second = V::Zero();
  // The weights of the second side are those of its own nearest points.
  const Nearest back = nearest(second, first, first);
  for (std::size_t c = 0; c < second.size(); ++c) s.on_second[Eigen::Index(c)] = back.on_cloth[Eigen::Index(c)];
  s.near = s.nearest.gap > 0 && s.nearest.gap <= most_first + most_second;
  s.target = std::min(thickness_, s.nearest.gap);
}

void PlaneContactReference::query_self(const std::vector<double>& room) {
  for (SelfContact& s : self_) query_self(s, room);
}

void PlaneContactReference::wish_of(const SelfContact& s, int round) {
  const V& n = s.nearest.n;
  V apart = V::Zero(), slip = V::Zero();
  double mass = 0;
  const auto sum = [&](const std::vector<std::size_t>& side, const V& weights, double sign) {
    for (std::size_t c = 0; c < side.size(); ++c) {
      const double b = weights[Eigen::Index(c)];
      apart += sign * b * y_[side[c]];
      slip += sign * b * (y_[side[c]] - x0_[side[c]]);
      mass += w_[side[c]] * b * b;
    }
  };
  sum(s.first, s.nearest.on_cloth, 1);
  sum(s.second, s.on_second, -1);
  const double push = s.target - n.dot(apart);
  const double out = round == 0 ? std::clamp(thickness_ - s.target, 0.0, kRecovered * thickness_) : 0;
  if (!(push + out > 0)) return;
  const double moving = std::max(0.0, push);
  slip -= slip.dot(n) * n;
  V by = moving * n;
  if (slip.norm() > 0 && moving > 0)
    by -= std::min(1.0, scene_.cloth.self_collision.friction * moving / slip.norm()) * slip;
  ++self_responses;
  const auto share = [&](const std::vector<std::size_t>& side, const V& weights, double sign) {
    for (std::size_t c = 0; c < side.size(); ++c) {
      const double part = sign * w_[side[c]] * weights[Eigen::Index(c)] / mass;
      self_wishes_[side[c]].push_back({part * by, part * (push + out - moving) * n});
    }
  };
  share(s.first, s.nearest.on_cloth, 1);
  share(s.second, s.on_second, -1);
}

void PlaneContactReference::wish_self(int round) {
  for (const SelfContact& s : self_)
    if (s.near) wish_of(s, round);
}

void PlaneContactReference::choose_self() {
  for (auto& all : self_planes_) all.clear();
  for (std::size_t k = 0; k < self_pairs_; ++k) {
    const SelfContact& s = self_[k];
    if (!s.near) continue;
    const V& n = s.nearest.n;
    double start_a = 1e30, end_a = 1e30, start_b = -1e30, end_b = -1e30;
    for (const std::size_t i : s.first) {
      start_a = std::min(start_a, n.dot(x0_[i]));
      end_a = std::min(end_a, n.dot(y_[i]));
    }
    for (const std::size_t i : s.second) {
      start_b = std::max(start_b, n.dot(x0_[i]));
      end_b = std::max(end_b, n.dot(y_[i]));
    }
    const double half = 0.5 * std::min(kGuard, start_a - start_b);
    const double middle = std::clamp(0.5 * (end_a + end_b), start_b + half, start_a - half);
    for (const std::size_t i : s.first) self_planes_[i].push_back({n, middle + half});
    for (const std::size_t i : s.second) self_planes_[i].push_back({-n, half - middle});
  }
}

}  // namespace clothbench::pbd_gpu
