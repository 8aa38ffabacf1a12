#include "metrics/contact/wrong_side.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>
#include <string>

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

Point<3> at(std::span<const double> x, std::size_t i) { return Point<3>::Map(x.data() + 3 * i); }

void append(std::vector<double>& x, const Point<3>& p) { x.insert(x.end(), {p[0], p[1], p[2]}); }

}  // namespace

/// A surface during one frame.
class WrongSide::Passage {
 public:
  Passage(const TriangleMeshView& was, const TriangleMeshView& is)
      // Welded by position: neighbouring quads share walls only where bones meet exactly, and then in the same order.
      : swept_(was, is, welded_vertices(was)),
        first_(was, was, welded_vertices(was)),
        last_(is, is, welded_vertices(is)) {}

  /// Whether the path p -> q passes it an odd number of times. None if that depends on when in the frame the sample
  /// moved: uniformly, at once, or at the end.
  std::optional<bool> passed(const Point<3>& p, const Point<3>& q) const {
    const auto odd = [](int crossings) { return crossings % 2 != 0; };
    const bool evenly = odd(swept_.signed_crossings(p, q));
    const bool at_once = odd(first_.signed_crossings(p, q) + swept_.signed_crossings(q, q));
    const bool at_the_end = odd(swept_.signed_crossings(p, p) + last_.signed_crossings(p, q));
    if (evenly == at_once && evenly == at_the_end) return evenly;
    return std::nullopt;
  }

  /// Whether the surface lies between two points at the end of the frame.
  bool between(const Point<3>& p, const Point<3>& q) const { return last_.signed_crossings(p, q) % 2 != 0; }

 private:
  SweptMesh swept_, first_, last_;
};

WrongSide::WrongSide(std::span<const Bone> bones, const Point<3>& side, double reach_m, std::size_t samples,
                     std::vector<Link> links)
    : side_(side), reach_m_(reach_m), links_(std::move(links)) {
  if (!(std::abs(side.norm() - 1) <= 1e-9) || !(reach_m > 0))
    throw Error("wrong side: expected a side of length 1 and a reach above 0");
  for (const Link& l : links_)
    if (!(std::max(l[0], l[1]) < samples))
      throw Error("wrong side: a link of sample " + std::to_string(std::max(l[0], l[1])) + ", expected below " +
                  std::to_string(samples));
  links_of_.resize(samples);
  for (std::size_t l = 0; l < links_.size(); ++l)
    for (const std::uint32_t i : links_[l]) links_of_[i].push_back(l);
  std::vector<double> ends;
  for (const Bone& b : bones)
    for (const Point<3>& p : b) append(ends, p);
  const std::vector<std::uint32_t> node = welded_vertices({ends, {}});
  // Chains are the connected components: each bone's label drops to the least label of the bones it is joined to.
  std::vector<std::size_t> label(bones.size());
  std::iota(label.begin(), label.end(), std::size_t{0});
  const auto joined = [&](std::size_t i, std::size_t j) {
    return node[2 * i] == node[2 * j] || node[2 * i] == node[2 * j + 1] || node[2 * i + 1] == node[2 * j] ||
           node[2 * i + 1] == node[2 * j + 1];
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
    chains.try_emplace(label[i]).first->second.bones.push_back(i);
  }
  for (auto& [unused, chain] : chains) {
    for (const std::size_t b : chain.bones) {
      add_quad(chain.wake.triangles, 4 * (chain.wake.triangles.size() / 2));
      for (std::size_t end : {0u, 1u})
        if (degree[node[2 * b + end]] == 1) {
          add_quad(chain.beyond.triangles, 4 * chain.free_ends.size());
          chain.free_ends.push_back({b, end});
        }
    }
    chain.endless.triangles = chain.wake.triangles;
    for (std::size_t k = 0; k < chain.free_ends.size(); ++k)
      add_quad(chain.endless.triangles, 4 * (chain.bones.size() + k));
    for (Surface* s : {&chain.wake, &chain.endless}) s->odd.resize(samples);
    chain.rounded.emplace(samples);
    chain.torn.resize(links_.size());
    chain.through.resize(samples);
    place(chain, bones);
    chains_.push_back(std::move(chain));
  }
}

void WrongSide::place(Chain& chain, std::span<const Bone> bones) const {
  std::vector<double>&wake = chain.wake.at, &endless = chain.endless.at, &beyond = chain.beyond.at;
  wake.clear();
  beyond.clear();
  const Point<3> far = reach_m_ * side_;
  for (const std::size_t b : chain.bones) {
    const auto& [a, e] = bones[b];
    for (const Point<3>& p : {a, e, Point<3>(e + far), Point<3>(a + far)}) append(wake, p);
  }
  endless = wake;
  for (const auto& [b, end] : chain.free_ends) {
    const Point<3> tip = bones[b][end], along = (tip - bones[b][1 - end]).normalized();
    Point<3> across = side_.cross(along);
    // For a bone parallel to the side the half-plane has no width, and nothing passes it.
    across = across.norm() > 1e-6 ? Point<3>(reach_m_ * across.normalized()) : Point<3>(Point<3>::Zero());
    const Point<3> out = reach_m_ * along;
    for (const Point<3>& p :
         {Point<3>(tip - across), Point<3>(tip + across), Point<3>(tip + across + out), Point<3>(tip - across + out)})
      append(beyond, p);
    // Wound as the bone's own quad, so that crossings of both have the same sign.
    const std::array<Point<3>, 2> ends =
        end == 1 ? std::array<Point<3>, 2>{tip, tip + out} : std::array<Point<3>, 2>{tip + out, tip};
    for (const Point<3>& p : {ends[0], ends[1], Point<3>(ends[1] + far), Point<3>(ends[0] + far)}) append(endless, p);
  }
}

void WrongSide::advance(std::span<const double> samples, std::span<const Bone> bones, const Evidence& evidence) {
  lost_ = lost_ || !all_finite(samples);
  if (lost_) return;
  for (Chain& chain : chains_) {
    const std::vector<double> wake = chain.wake.at, endless = chain.endless.at, beyond = chain.beyond.at;
    place(chain, bones);
    if (before_.empty()) continue;
    const TriangleMeshView out{beyond, chain.beyond.triangles};
    chain.rounded->advance(before_, samples,
                           SweptMesh(out, {chain.beyond.at, chain.beyond.triangles}, welded_vertices(out)),
                           {[] { return true; }, {}});
    const Passage passage({wake, chain.wake.triangles}, {chain.wake.at, chain.wake.triangles});
    follow(chain.wake, passage, samples);
    if (links_.empty()) continue;
    const Passage endless_passage({endless, chain.endless.triangles}, {chain.endless.at, chain.endless.triangles});
    follow(chain.endless, endless_passage, samples);
    find_torn(chain, passage, endless_passage, samples, evidence);
  }
  before_.assign(samples.begin(), samples.end());
}

void WrongSide::follow(Surface& surface, const Passage& passage, std::span<const double> samples) const {
  std::vector<std::size_t> unclear;
  for (std::size_t i = 0; i < surface.odd.size(); ++i) {
    const std::optional<bool> passed = passage.passed(at(before_, i), at(samples, i));
    if (!passed)
      unclear.push_back(i);
    else if (*passed)
      surface.odd[i] = !surface.odd[i];
  }
  for (const std::size_t i : unclear) {
    int votes = 0;
    for (const std::size_t l : links_of_[i]) votes += parted(surface, passage, links_[l], samples) ? 1 : -1;
    if (votes > 0) surface.odd[i] = !surface.odd[i];
  }
}

bool WrongSide::parted(const Surface& surface, const Passage& passage, const Link& link,
                       std::span<const double> samples) const {
  return passage.between(at(samples, link[0]), at(samples, link[1])) != (surface.odd[link[0]] != surface.odd[link[1]]);
}

void WrongSide::find_torn(Chain& chain, const Passage& wake, const Passage& endless, std::span<const double> samples,
                          const Evidence& evidence) const {
  const std::vector<bool>& odd = chain.wake.odd;
  std::vector<bool>& through = chain.through;
  through.assign(odd.size(), false);
  for (std::size_t l = 0; l < links_.size(); ++l) {
    const Link& ends = links_[l];
    const auto& [a, b] = ends;
    // A link between even samples is looked at only where its state can change.
    if (!odd[a] && !odd[b] && !chain.torn[l] && !evidence.contour) continue;
    const bool torn = parted(chain.wake, wake, ends, samples) && parted(chain.endless, endless, ends, samples);
    const auto shown = [&] {
      return evidence.contour || (evidence.crosses && evidence.crosses(at(samples, a), at(samples, b)));
    };
    chain.torn[l] = torn && (chain.torn[l] || shown());
    if (!chain.torn[l]) continue;
    for (const std::uint32_t i : ends) through[i] = through[i] || odd[i];
  }
  // It spreads from one sample of a piece to all others.
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto& [a, b] : links_)
      if (odd[a] && odd[b] && through[a] != through[b]) through[a] = through[b] = changed = true;
  }
}

bool WrongSide::Chain::wrong(std::size_t sample) const {
  return wake.odd[sample] && (torn.empty() || through[sample]) && rounded->counts()[sample] == 0;
}

bool WrongSide::wrong(std::size_t sample) const {
  return std::any_of(chains_.begin(), chains_.end(), [&](const Chain& c) { return c.wrong(sample); });
}

bool WrongSide::laid_over(std::size_t sample) const {
  return !wrong(sample) &&
         std::any_of(chains_.begin(), chains_.end(), [&](const Chain& c) { return c.wake.odd[sample]; });
}

std::size_t WrongSide::count() const {
  std::size_t n = 0;
  for (std::size_t i = 0; i < before_.size() / 3; ++i) n += wrong(i);
  return n;
}

}  // namespace clothbench::contact
