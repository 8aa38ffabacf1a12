#include "metrics/contact/wrong_side.hpp"

#include <algorithm>
#include <map>
#include <numeric>

#include "clothbench/error.hpp"

namespace clothbench::contact {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

/// Two triangles on four corners round a quadrilateral that starts at vertex `first`.
void add_quad(Triangles& t, std::size_t first) {
  const auto v = static_cast<std::uint32_t>(first);
  t.push_back({v, v + 1, v + 2});
  t.push_back({v, v + 2, v + 3});
}

void append(std::vector<double>& x, const Point<3>& p) { x.insert(x.end(), {p[0], p[1], p[2]}); }

}  // namespace

WrongSide::WrongSide(std::span<const Bone> bones, const Point<3>& side, double reach_m, std::size_t samples)
    : side_(side), reach_m_(reach_m) {
  if (!(std::abs(side.norm() - 1) <= 1e-9) || !(reach_m > 0))
    throw Error("wrong side: expected a side of length 1 and a reach above 0");
  std::vector<double> ends;
  for (const Bone& b : bones)
    for (const Point<3>& p : b) append(ends, p);
  const std::vector<std::uint32_t> node = welded_vertices({ends, {}});
  // Chains are the connected parts: each bone's label sinks to the least of what it is joined to.
  std::vector<std::size_t> label(bones.size());
  std::iota(label.begin(), label.end(), std::size_t{0});
  const auto joined = [&](std::size_t i, std::size_t j) {
    return node[2 * i] == node[2 * j] || node[2 * i] == node[2 * j + 1] || node[2 * i + 1] == node[2 * j] || node[2 * i + 1] == node[2 * j + 1];
  };
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t i = 0; i < bones.size(); ++i)
      for (std::size_t j = 0; j < bones.size(); ++j)
        if (label[j] < label[i] && joined(i, j)) label[i] = label[j], changed = true;
  }
  std::map<std::uint32_t, int> degree;
  std::map<std::size_t, Chain> chains;
  for (std::size_t i = 0; i < bones.size(); ++i) {
    if (bones[i][0] == bones[i][1]) continue;
    ++degree[node[2 * i]];
    ++degree[node[2 * i + 1]];
    chains.try_emplace(label[i], Chain{{}, {}, {}, {}, {}, {}, TunnelHistory(samples), TunnelHistory(samples)}).first->second.bones.push_back(i);
  }
  for (auto& [unused, chain] : chains) {
    for (const std::size_t b : chain.bones) {
      add_quad(chain.wake_triangles, 4 * (chain.wake_triangles.size() / 2));
      for (std::size_t end : {0u, 1u})
        if (degree[node[2 * b + end]] == 1) {
          add_quad(chain.beyond_triangles, 4 * chain.free_ends.size());
          chain.free_ends.push_back({b, end});
        }
    }
    place(chain, bones, chain.wake, chain.beyond);
    chains_.push_back(std::move(chain));
  }
}

void WrongSide::place(const Chain& chain, std::span<const Bone> bones, std::vector<double>& wake, std::vector<double>& beyond) const {
  wake.clear();
  beyond.clear();
  const Point<3> far = reach_m_ * side_;
  for (const std::size_t b : chain.bones) {
    const auto& [a, e] = bones[b];
    for (const Point<3>& p : {a, e, Point<3>(e + far), Point<3>(a + far)}) append(wake, p);
  }
  for (const auto& [b, end] : chain.free_ends) {
    const Point<3> tip = bones[b][end], along = (tip - bones[b][1 - end]).normalized();
    Point<3> across = side_.cross(along);
    // Parallel to the side: a half-plane without width, which nothing passes.
    across = across.norm() > 1e-6 ? Point<3>(reach_m_ * across.normalized()) : Point<3>(Point<3>::Zero());
    const Point<3> out = reach_m_ * along;
    for (const Point<3>& p : {Point<3>(tip - across), Point<3>(tip + across), Point<3>(tip + across + out), Point<3>(tip - across + out)})
      append(beyond, p);
  }
}

void WrongSide::advance(std::span<const double> samples, std::span<const Bone> bones) {
  lost_ = lost_ || !all_finite(samples);
  if (lost_) return;
  for (Chain& chain : chains_) {
    std::vector<double> wake, beyond;
    place(chain, bones, wake, beyond);
    if (!before_.empty()) {
      // Welded as they stand: neighbouring quads share walls only where bones meet exactly, and then in the same order.
      const TriangleMeshView was{chain.wake, chain.wake_triangles}, is{wake, chain.wake_triangles};
      chain.crossed.advance(before_, samples, SweptMesh(was, is, welded_vertices(was)));
      const TriangleMeshView out_was{chain.beyond, chain.beyond_triangles}, out_is{beyond, chain.beyond_triangles};
      chain.rounded.advance(before_, samples, SweptMesh(out_was, out_is, welded_vertices(out_was)));
    }
    chain.wake = std::move(wake);
    chain.beyond = std::move(beyond);
  }
  before_.assign(samples.begin(), samples.end());
}

bool WrongSide::wrong(std::size_t sample) const {
  return std::any_of(chains_.begin(), chains_.end(), [&](const Chain& c) {
    return c.crossed.counts()[sample] % 2 != 0 && c.rounded.counts()[sample] == 0;
  });
}

std::size_t WrongSide::count() const {
  std::size_t n = 0;
  for (std::size_t i = 0; i < before_.size() / 3; ++i) n += wrong(i);
  return n;
}

}  // namespace clothbench::contact
