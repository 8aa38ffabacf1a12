#include "xpbd/mesh/edge_paths.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "clothbench/vector.hpp"
#include "xpbd/constraints.hpp"

namespace clothbench::pbd_gpu {
namespace {

/// Edges below this fraction of the mean are welded.
constexpr double kSliver = 0.02;

double mean_length(const std::vector<Edge>& all) {
  double sum = 0;
  for (const Edge& e : all) sum += e.rest_m;
  return sum / static_cast<double>(all.size());
}

std::vector<EdgePath> grid_edge_paths(const Scene& s) {
  const int columns = s.cloth.columns, rows = s.cloth.rows;
  std::vector<EdgePath> out;
  const auto line = [&](int i, int j, int di, int dj, int colour) {
    EdgePath path{{}, colour};
    for (; i >= 0 && i < columns && j < rows; i += di, j += dj)
      path.vertices.push_back(static_cast<std::uint32_t>(j * columns + i));
    if (path.vertices.size() > 1) out.push_back(std::move(path));
  };
  // Colours in the order in which they are solved: diagonals, columns, rows (xpbd/README.md).
  int colour = 0;
  if (s.needs.has(Feature::Shear)) {
    for (int i = 0; i < columns; ++i) line(i, 0, -1, 1, colour);
    for (int j = 1; j < rows; ++j) line(columns - 1, j, -1, 1, colour);
    ++colour;
    for (int i = 0; i < columns; ++i) line(i, 0, 1, 1, colour);
    for (int j = 1; j < rows; ++j) line(0, j, 1, 1, colour);
    ++colour;
  }
  for (int i = 0; i < columns; ++i) line(i, 0, 0, 1, colour);
  ++colour;
  for (int j = 0; j < rows; ++j) line(0, j, 1, 0, colour);
  return out;
}

/// Cuts a ring of elastic links (whose last vertex repeats its first) into two overlapping edge paths, and adds them. A
/// chain overstretches at its end, because chains that are solved later pull there with their whole tension. In the
/// overlap one path's stiffness falls link by link as the other's rises, so tension changes little from link to link.
void add_ring(EdgePath ring, std::vector<EdgePath>& out) {
  constexpr std::size_t kOverlap = 8;  // links on either side of the cut
  const std::size_t n = ring.vertices.size() - 1;
  if (n < 4 * kOverlap) {
    out.push_back(std::move(ring));
    return;
  }
  EdgePath over;
  for (std::size_t k = 0; k < 2 * kOverlap + 2; ++k) over.vertices.push_back(ring.vertices[(n - 1 - kOverlap + k) % n]);
  ring.vertices.pop_back();
  ring.share.assign(n - 1, 1);
  over.share.assign(2 * kOverlap + 1, 1);
  for (std::size_t k = 0; k < kOverlap; ++k) {
    const float share = static_cast<float>(k + 1) / (kOverlap + 1);
    ring.share[k] = ring.share[n - 2 - k] = share;
    over.share[kOverlap + 1 + k] = over.share[kOverlap - 1 - k] = 1 - share;
  }
  out.push_back(std::move(ring));
  out.push_back(std::move(over));
}

/// Pairs edges that continue each other at a vertex, the straightest pairs first. A sequence of pairs is an edge path.
std::vector<EdgePath> mesh_edge_paths(const ClothMesh& m, bool rings_overlap) {
  constexpr double kStraight = -0.5;  // a turn of less than 60 degrees
  const std::size_t n = m.vertices.size(), count = m.edges.size();
  std::vector<std::vector<std::uint32_t>> at(n);
  for (std::uint32_t e = 0; e < count; ++e) {
    at[m.edges[e].a].push_back(e);
    at[m.edges[e].b].push_back(e);
  }
  constexpr auto kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::array<std::uint32_t, 2>> next(count, {kNone, kNone});  // at end a, at end b
  for (std::uint32_t v = 0; v < n; ++v) {
    struct Pair {
      double cosine;
      std::uint32_t p, q;
    };
    std::vector<Pair> pairs;
    const auto away = [&](std::uint32_t e) {
      return minus(m.vertices[m.edges[e].a == v ? m.edges[e].b : m.edges[e].a], m.vertices[v]);
    };
    for (std::size_t i = 0; i < at[v].size(); ++i)
      for (std::size_t k = i + 1; k < at[v].size(); ++k) {
        const std::uint32_t p = at[v][i], q = at[v][k];
        const double cosine = dot(away(p), away(q)) / (m.edges[p].rest_m * m.edges[q].rest_m);
        if (cosine < kStraight) pairs.push_back({cosine, p, q});
      }
    std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
      return a.cosine != b.cosine ? a.cosine < b.cosine : a.p != b.p ? a.p < b.p : a.q < b.q;
    });
    for (const Pair& pair : pairs) {
      std::uint32_t& p = next[pair.p][m.edges[pair.p].a == v ? 0 : 1];
      std::uint32_t& q = next[pair.q][m.edges[pair.q].a == v ? 0 : 1];
      if (p != kNone || q != kNone) continue;
      p = pair.q;
      q = pair.p;
    }
  }
  std::vector<std::uint8_t> done(count, 0);
  std::vector<EdgePath> out;
  const auto follow = [&](std::uint32_t e, std::uint32_t from) {
    EdgePath path{{from}, -1};
    while (e != kNone && done[e] == 0) {
      done[e] = 1;
      const Edge& edge = m.edges[e];
      from = edge.a == from ? edge.b : edge.a;
      path.vertices.push_back(from);
      e = next[e][edge.a == from ? 0 : 1];
    }
    out.push_back(std::move(path));
  };
  for (const std::size_t end : {0u, 1u})
    for (std::uint32_t e = 0; e < count; ++e)
      if (done[e] == 0 && next[e][end] == kNone) follow(e, end == 0 ? m.edges[e].a : m.edges[e].b);
  // The rest are rings. A ring is cut where it begins, and the link there stretches far more than others. The cuts of
  // neighbouring rings are far apart, so that the cloth between them limits this stretch.
  constexpr double kGolden = 0.6180339887498949;
  double begin = 0;
  for (std::uint32_t e = 0; e < count; ++e) {
    if (done[e] != 0) continue;
    follow(e, m.edges[e].a);
    EdgePath whole = std::move(out.back());
    out.pop_back();
    std::vector<std::uint32_t>& ring = whole.vertices;
    ring.pop_back();
    std::rotate(ring.begin(), ring.begin() + static_cast<std::ptrdiff_t>(begin * static_cast<double>(ring.size())),
                ring.end());
    ring.push_back(ring.front());
    if (rings_overlap)
      add_ring(std::move(whole), out);
    else
      out.push_back(std::move(whole));
    begin = std::fmod(begin + kGolden, 1.0);
  }
  return out;
}

}  // namespace

bool needs_chain_solver(const Scene& s) {
  return !(s.needs & FeatureSet{Feature::ClothMesh, Feature::UnevenGrid, Feature::Regions}).empty();
}

double substeps_for_short_links(const Scene& s) {
  const std::vector<Edge> all = edges(s.cloth, EdgeKind::Structural);
  const double mean = mean_length(all);
  double shortest = mean;
  for (const Edge& e : all)
    if (e.rest_m >= kSliver * mean) shortest = std::min(shortest, e.rest_m);
  return std::max(1.0, std::sqrt(mean / (2 * shortest)));
}

ChainCloth chain_cloth(const Scene& s) {
  ChainCloth c;
  c.particle.resize(s.cloth.vertex_count());
  std::iota(c.particle.begin(), c.particle.end(), 0u);
  std::vector<Edge> all = edges(s.cloth, EdgeKind::Structural);
  const double mean = mean_length(all);
  const auto root = [&](std::uint32_t v) {
    while (c.particle[v] != v) v = c.particle[v];
    return v;
  };
  if (s.grips.vertices.empty())
    for (const Edge& e : all)
      if (e.rest_m < kSliver * mean) {
        const std::uint32_t a = root(e.a), b = root(e.b);
        c.particle[std::max(a, b)] = std::min(a, b);
      }
  for (std::uint32_t v = 0; v < c.particle.size(); ++v) {
    c.particle[v] = root(v);
    if (c.particle[v] != v) c.welded.push_back(v);
  }
  std::vector<std::optional<double>> stiffness = edge_stiffnesses(s);
  if (s.needs.has(Feature::Shear))
    for (const Edge& e : edges(s.cloth, EdgeKind::Shear)) {
      all.push_back(e);
      stiffness.push_back(membrane_stiffness(s, e));
    }
  // Adds the stiffnesses of links that welding made parallel.
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::pair<double, double>> links;  // rest, stiffness
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Edge& e = all[k];
    const auto ends = std::minmax(c.particle[e.a], c.particle[e.b]);
    if (ends.first == ends.second) continue;
    const double spring = stiffness[k] ? spring_N_per_m(s, e, *stiffness[k]) : INFINITY;
    const auto [at, fresh] = links.emplace(ends, std::pair(e.rest_m, spring));
    if (!fresh) at->second.second += spring;
  }
  for (const auto& [ends, link] : links)
    c.links.push_back({ends.first, ends.second, static_cast<float>(link.first), static_cast<float>(1 / link.second)});
  return c;
}

const ChainCloth::Link& ChainCloth::link(std::uint32_t a, std::uint32_t b) const {
  const Link wanted{std::min(a, b), std::max(a, b), 0, 0};
  return *std::lower_bound(links.begin(), links.end(), wanted,
                           [](const Link& p, const Link& q) { return p.a != q.a ? p.a < q.a : p.b < q.b; });
}

std::vector<EdgePath> edge_paths(const Scene& s, const ChainCloth& cloth) {
  std::vector<EdgePath> all =
      s.cloth.mesh ? mesh_edge_paths(*s.cloth.mesh, s.material.membrane_stiffness_N_per_m && cloth.welded.empty())
                   : grid_edge_paths(s);
  if (cloth.welded.empty()) return all;
  std::vector<std::uint8_t> seen(cloth.links.size(), 0);
  std::vector<EdgePath> out;
  for (const EdgePath& path : all) {
    EdgePath part{{cloth.particle[path.vertices[0]]}, path.colour};
    const auto end = [&](std::uint32_t next) {
      if (part.vertices.size() > 1) out.push_back(part);
      part.vertices = {next};
    };
    for (std::size_t k = 1; k < path.vertices.size(); ++k) {
      const std::uint32_t before = part.vertices.back(), now = cloth.particle[path.vertices[k]];
      if (before == now) continue;
      std::uint8_t& is_seen = seen[static_cast<std::size_t>(&cloth.link(before, now) - cloth.links.data())];
      if (is_seen != 0)
        end(now);
      else
        part.vertices.push_back(now);
      is_seen = 1;
    }
    end(0);
  }
  return out;
}

std::uint32_t ChainColour::longest() const {
  std::size_t largest = 1;
  for (const EdgePath& c : chains) largest = std::max(largest, c.vertices.size());
  return static_cast<std::uint32_t>(largest - 1);
}

std::vector<ChainColour> colours_of(std::vector<EdgePath> all, std::size_t vertices, std::uint32_t block) {
  // A compromise: each colour costs a pass, but an edge path overstretches where it is cut into chains.
  constexpr std::size_t kEnough = 6, kShort = 4;
  int wanted = 0;
  for (const EdgePath& s : all) wanted = std::max(wanted, s.colour + 1);
  std::stable_sort(all.begin(), all.end(),
                   [](const EdgePath& a, const EdgePath& b) { return a.vertices.size() > b.vertices.size(); });
  std::vector<ChainColour> colours(static_cast<std::size_t>(wanted));
  std::vector<std::vector<std::uint8_t>> used(colours.size(), std::vector<std::uint8_t>(vertices, 0));
  std::vector<std::uint32_t> stamp(vertices, 0);
  std::uint32_t now = 0;
  /// Number of the edge path's links, from its vertex number `from` on, that fit into colour `f`.
  const auto fits = [&](std::size_t f, const EdgePath& s, std::size_t from) {
    ++now;
    std::size_t k = from;
    while (k < s.vertices.size() && k - from < block && used[f][s.vertices[k]] == 0 && stamp[s.vertices[k]] != now)
      stamp[s.vertices[k++]] = now;
    return k - from > 1 ? k - from - 1 : 0;
  };
  for (const EdgePath& s : all)
    for (std::size_t from = 0; from + 1 < s.vertices.size();) {
      std::size_t best = 0, largest = 0;
      for (std::size_t f = 0; f < colours.size(); ++f)
        if (const std::size_t links = fits(f, s, from); links > largest) {
          best = f;
          largest = links;
        }
      if (s.colour >= 0)
        if (const std::size_t links = fits(static_cast<std::size_t>(s.colour), s, from); links > 0) {
          best = static_cast<std::size_t>(s.colour);
          largest = links;
        }
      const std::size_t left = s.vertices.size() - 1 - from;
      if (largest == 0 || (largest < std::min(kShort, left) && colours.size() < kEnough)) {
        colours.emplace_back();
        used.emplace_back(vertices, 0);
        best = colours.size() - 1;
        largest = fits(best, s, from);
      }
      const auto first = s.vertices.begin() + static_cast<std::ptrdiff_t>(from);
      EdgePath& chain = colours[best].chains.emplace_back();
      chain.vertices.assign(first, first + static_cast<std::ptrdiff_t>(largest + 1));
      if (!s.share.empty()) {
        const auto share = s.share.begin() + static_cast<std::ptrdiff_t>(from);
        chain.share.assign(share, share + static_cast<std::ptrdiff_t>(largest));
      }
      for (std::size_t k = from; k <= from + largest; ++k) used[best][s.vertices[k]] = 1;
      from += largest;
    }
  for (ChainColour& colour : colours)  // by place in memory, no longer by length
    std::ranges::stable_sort(colour.chains, {}, [](const EdgePath& path) { return path.vertices[0]; });
  // Colours that were opened later have shorter chains. They are solved first and the long ones last, so that the long
  // ones are satisfied best.
  if (wanted == 0)
    std::reverse(colours.begin(), colours.end());
  else
    std::rotate(colours.begin(), colours.begin() + wanted, colours.end());
  return colours;
}

std::vector<ChainEntry> entries_of(const ChainColour& colour, const Scene& scene, const ChainCloth& cloth,
                                   std::uint32_t block, bool with_others) {
  const std::size_t n = scene.cloth.vertex_count();
  std::vector<std::uint8_t> held(n, 0), seen(n, 0);
  for (const std::uint32_t v : scene.pins.vertices) held[cloth.particle[v]] = 1;
  for (const std::uint32_t v : scene.grips.vertices) held[v] = 1;
  std::vector<ChainEntry> out;
  const ChainEntry padding{CHAIN_NO_VERTEX, -1, 0, 0};
  const auto put = [&](const std::vector<ChainEntry>& entries) {
    if (out.size() % block + entries.size() > block) out.resize((out.size() / block + 1) * block, padding);
    out.insert(out.end(), entries.begin(), entries.end());
  };
  for (const EdgePath& path : colour.chains) {
    const std::vector<std::uint32_t>& chain = path.vertices;
    const auto held_ones = std::count_if(chain.begin(), chain.end(), [&](std::uint32_t v) { return held[v] != 0; });
    std::vector<ChainEntry> entries;
    for (std::size_t k = 0; k < chain.size(); ++k) {
      const bool goes_on = k + 1 < chain.size();
      ChainCloth::Link l = goes_on ? cloth.link(chain[k], chain[k + 1]) : ChainCloth::Link{0, 0, -1, 0};
      if (goes_on && !path.share.empty()) l.compliance_m_per_N /= path.share[k];
      entries.push_back(
          {chain[k], l.rest_m, l.compliance_m_per_N, held_ones > 1 ? static_cast<float>(kRegularisation) : 0.0f});
      seen[chain[k]] = 1;
    }
    put(entries);
  }
  if (with_others)
    for (std::uint32_t v = 0; v < n; ++v)
      if (seen[v] == 0 && cloth.particle[v] == v) put({{v, -1, 0, 0}});
  out.resize((out.size() + block - 1) / block * block, padding);
  return out;
}

}  // namespace clothbench::pbd_gpu
