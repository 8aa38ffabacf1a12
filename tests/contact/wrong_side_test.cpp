// Fingers through, along and round sheets whose samples on the wrong side are known.
#include "metrics/contact/wrong_side.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "clothbench/error.hpp"
#include "metrics/contact/pierce.hpp"
#include "metrics/contact/surface.hpp"
#include "metrics/contact/touch.hpp"

namespace clothbench::contact {
namespace {

using P = Point<3>;
using Sheet = std::function<P(double u, double v)>;

constexpr int kSide = 41;  // samples a side of a sheet of 1 m: none on a line x = 0.3 or y = 0.12 below

std::vector<double> sampled(const Sheet& at) {
  std::vector<double> out;
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i) {
      const P p = at(i * 1.0 / (kSide - 1) - 0.5, j * 1.0 / (kSide - 1) - 0.5);
      out.insert(out.end(), {p[0], p[1], p[2]});
    }
  return out;
}

P flat(double u, double v) { return {u, v, 0}; }

/// A finger of 0.3 m along y at (x, z), its tip at y = 0.11 + shift, in three joined bones.
std::vector<Bone> finger(double x, double z, double shift = 0) {
  std::vector<Bone> out;
  for (int k = 0; k < 3; ++k) out.push_back({P(x, shift - 0.19 + 0.1 * k, z), P(x, shift - 0.19 + 0.1 * (k + 1), z)});
  return out;
}

std::vector<Link> links() {
  std::vector<Link> out;
  for (std::uint32_t j = 0; j < kSide; ++j)
    for (std::uint32_t i = 0; i < kSide; ++i) {
      const std::uint32_t k = j * kSide + i;
      if (i + 1 < kSide) out.push_back({k, k + 1});
      if (j + 1 < kSide) out.push_back({k, k + kSide});
    }
  return out;
}

WrongSide watch(const std::vector<Bone>& start, std::vector<Link> with = links()) {
  return WrongSide(start, P(0, 0, 1), 10, kSide * kSide, std::move(with));
}

/// There was a contour in the frame or the one before.
const Evidence kContour{true, {}};

std::size_t laid_over(const WrongSide& w) {
  std::size_t n = 0;
  for (std::size_t i = 0; i < kSide * kSide; ++i) n += w.laid_over(i);
  return n;
}

TEST(WrongSide, ASheetPushedAsideHasNone) {
  // Down 0.05 m at x = 0.3, then along to x = -0.3; the sheet hangs in a tent round the finger wherever it is and
  // closes behind.
  const auto at = [](double t) { return t < 1 ? P(0.3013, 0, 0.05 - 0.1 * t) : P(0.3013 - 0.6 * (t - 1), 0, -0.05); };
  WrongSide w = watch(finger(at(0)[0], at(0)[2]));
  for (int frame = 0; frame <= 40; ++frame) {
    const P place = at(frame / 20.0);
    const double floor = place[2] - 0.01;
    w.advance(sampled([&](double u, double v) {
                const double beside = std::max(0.0, std::abs(u - place[0]) - 0.03) / 0.1,
                             beyond = std::max(0.0, std::max(v - 0.11, -0.19 - v)) / 0.1;
                return P(u, v, std::min(0.0, floor + 0.1 * (beside + beyond)));
              }),
              finger(place[0], place[2]), kContour);
    ASSERT_EQ(w.count(), 0u) << "frame " << frame;
    ASSERT_EQ(laid_over(w), 0u) << "frame " << frame;
  }
}

TEST(WrongSide, AFingerTeleportedThroughLeavesExactlyTheSweptStrip) {
  for (const int frames : {1, 2, 7}) {
    // From (0.2, +0.1) to (-0.2, -0.1): below the sheet from x = 0 on.
    WrongSide w = watch(finger(0.2, 0.1));
    for (int f = 0; f <= frames; ++f)
      w.advance(sampled(flat), finger(0.2 - 0.4 * f / frames + 0.0013, 0.1 - 0.2 * f / frames), kContour);
    std::size_t strip = 0;
    for (int j = 0; j < kSide; ++j)
      for (int i = 0; i < kSide; ++i) {
        const double u = i * 1.0 / (kSide - 1) - 0.5, v = j * 1.0 / (kSide - 1) - 0.5;
        const bool swept = u > -0.1987 && u < 0.0013 && v > -0.19 && v < 0.11;
        EXPECT_EQ(w.wrong(static_cast<std::size_t>(j * kSide + i)), swept)
            << u << " " << v << " in " << frames << " frames";
        strip += swept;
      }
    EXPECT_EQ(w.count(), strip);
    EXPECT_EQ(strip, 8u * 12u);
    EXPECT_EQ(laid_over(w), 0u);
    // Out again as it came.
    w.advance(sampled(flat), finger(0.2013, 0.1));
    EXPECT_EQ(w.count(), 0u);
  }
}

/// The sheet is carried from below the finger to above it, round its tip or straight through; then the finger sweeps.
std::size_t carried(bool round) {
  WrongSide w = watch(finger(0.2, 0.05));
  w.advance(sampled(flat), finger(0.2, 0.05));
  const std::vector<P> ways =
      round ? std::vector<P>{P(0, 1, 0), P(0, 1, 0.1), P(0, 0, 0.1)} : std::vector<P>{P(0, 0, 0.1)};
  for (const P& way : ways)
    w.advance(sampled([&](double u, double v) { return P(flat(u, v) + way); }), finger(0.2, 0.05), kContour);
  EXPECT_EQ(w.count(), 0u);
  for (const double x : {0.1013, -0.0987, -0.1987})
    w.advance(sampled([&](double u, double v) { return P(u, v, 0.1); }), finger(x, 0.05), kContour);
  return w.count();
}

TEST(WrongSide, ASheetRoundTheFingertipHasNone) {
  EXPECT_EQ(carried(true), 0u);
  EXPECT_GT(carried(false), 50u) << "the same without the way round";
}

TEST(WrongSide, ABorderLaidOverAFingerIsLaidOver) {
  // The strip beyond x = 0.36 turns up and over a finger that stands at (0.3, 0.05), by 130 degrees.
  const auto turned = [](double degrees) {
    return [=](double u, double v) {
      const double r = u - 0.36, angle = degrees * 0.0174532925;
      return r < 0 ? P(u, v, 0) : P(0.36 + r * std::cos(angle), v, r * std::sin(angle));
    };
  };
  const auto laid = [&](const std::vector<Link>& with, const Evidence& evidence) {
    WrongSide w = watch(finger(0.3, 0.05), with);
    for (int degrees = 0; degrees <= 130; degrees += 10)
      w.advance(sampled(turned(degrees)), finger(0.3, 0.05), evidence);
    return std::array{w.count(), laid_over(w)};
  };
  using Counts = std::array<std::size_t, 2>;
  EXPECT_EQ(laid(links(), {}), (Counts{0, 2 * 12}));
  EXPECT_EQ(laid(links(), kContour), (Counts{0, 2 * 12})) << "a contour elsewhere tears no link";
  EXPECT_EQ(laid({}, {}), (Counts{2 * 12, 0})) << "samples that do not know of one another";
}

/// Torn links without a contour count once one of them crosses the object.
TEST(WrongSide, WithoutEvidenceWhatIsPassedHasGoneRound) {
  for (const bool met : {false, true}) {
    WrongSide w = watch(finger(0.2, 0.1));
    const Evidence evidence{false, [&](const P&, const P&) { return met; }};
    for (int f = 0; f <= 3; ++f)
      w.advance(sampled(flat), finger(0.2 - 0.4 * f / 3 + 0.0013, 0.1 - 0.2 * f / 3), evidence);
    EXPECT_EQ(w.count(), met ? 8u * 12u : 0u);
    EXPECT_EQ(laid_over(w), met ? 0u : 8u * 12u);
    w.advance(sampled(flat), finger(0.2 - 0.4 + 0.0013, -0.1), kContour);
    EXPECT_EQ(w.count(), 8u * 12u) << "its links have been torn since";
  }
}

TEST(WrongSide, WhatIsPushedAsideWithinAFrameHasNotBeenPassed) {
  // The finger goes from x = 0.2 to -0.2 at z = -0.05; the first sample from z = 0 to -0.09, early or evenly; the
  // second stays.
  const std::vector<double> before{0, 0, 0, 0.021, 0, 0}, after{0, 0, -0.09, 0.021, 0, 0};
  const auto passed = [&](std::vector<Link> with) {
    WrongSide w(finger(0.2, -0.05), P(0, 0, 1), 10, 2, std::move(with));
    w.advance(before, finger(0.2, -0.05));
    w.advance(after, finger(-0.2, -0.05), kContour);
    return std::vector<bool>{w.wrong(0) || w.laid_over(0), w.wrong(1) || w.laid_over(1)};
  };
  EXPECT_EQ(passed({}), (std::vector<bool>{false, true}));
  EXPECT_EQ(passed({{0, 1}}), (std::vector<bool>{true, true}))
      << "its neighbour was passed, and nothing is between them";
}

TEST(WrongSide, RefusesLinksOfNoSample) {
  EXPECT_THROW(WrongSide(finger(0.2, 0.1), P(0, 0, 1), 10, 2, {{0, 2}}), Error);
}

TEST(WrongSide, OneWayThroughASharedJointCountsOnce) {
  // Samples exactly at the joints' heights, passed in one step.
  WrongSide w(finger(0.2, -0.05), P(0, 0, 1), 10, 2);
  w.advance(std::vector<double>{0, -0.09, 0, 0, 0.01, 0}, finger(0.2, -0.05));
  w.advance(std::vector<double>{0, -0.09, 0, 0, 0.01, 0}, finger(-0.2, -0.05));
  EXPECT_EQ(w.count(), 2u);
}

TEST(WrongSide, OnceNotFiniteNothingIsKnown) {
  WrongSide w = watch(finger(0.2, 0.1));
  std::vector<double> x = sampled(flat);
  w.advance(x, finger(0.2, 0.1));
  EXPECT_TRUE(w.known());
  x[5] = std::numeric_limits<double>::quiet_NaN();
  w.advance(x, finger(0.2, 0.1));
  w.advance(sampled(flat), finger(0.2, 0.1));
  EXPECT_FALSE(w.known());
}

TEST(Pierce, CountsTheAxesThatGoThrough) {
  const std::vector<double> square{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  const std::vector<std::array<std::uint32_t, 3>> two{{0, 1, 2}, {0, 2, 3}};
  const auto upright = [](double x, double y, double from, double to) { return Bone{P(x, y, from), P(x, y, to)}; };
  EXPECT_EQ(pierced({square, two}, std::vector<Bone>{upright(0.3, 0.6, -1, 1), upright(0.6, 0.3, 1, -1)}), 2u);
  EXPECT_EQ(pierced({square, two}, std::vector<Bone>{upright(0.5, 0.5, -1, 1)}), 1u) << "on the common edge";
  EXPECT_EQ(pierced({square, two}, std::vector<Bone>{upright(0.3, 0.6, 0.1, 1), upright(1.3, 0.6, -1, 1)}), 0u);
  EXPECT_EQ(pierced({square, two}, std::vector<Bone>{upright(0.3, 0.6, 0, 0)}), 0u) << "without length";
}

TEST(Touch, SeesEdgesAndFaces) {
  const Simplex<3> face{P(0, 0, 0), P(1, 0, 0), P(0, 1, 0)};
  const Capsule tip{P(0.3, 0.3, 0.5), P(0.3, 0.3, 0.1), 0.05}, across{P(0.5, -0.2, 0.1), P(0.6, -0.1, 0.1), 0.05};
  EXPECT_TRUE(within(face, tip, 0.0501));
  EXPECT_FALSE(within(face, tip, 0.0499));
  const double away = std::sqrt(0.1 * 0.1 + 0.1 * 0.1) - 0.05;
  EXPECT_TRUE(within(face, across, away + 1e-9));
  EXPECT_FALSE(within(face, across, away - 1e-9));
  // Two edges at right angles, one above the other; no corner is near.
  const Simplex<3> other{P(0.5, -0.5, 0.1), P(0.5, 0.4, 0.1), P(0.5, 0, 2)};
  EXPECT_TRUE(within(face, other, 0.1001));
  EXPECT_FALSE(within(face, other, 0.0999));
  EXPECT_TRUE(within(face, {P(0.2, 0.2, -1), P(0.2, 0.2, 1), P(3, 3, 0)}, 0)) << "they cross";
}

// Against sampling both segments finely.
TEST(Touch, DistanceOfSegments) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto point = [&] { return P(unit(random), unit(random), unit(random)); };
  for (int trial = 0; trial < 200; ++trial) {
    const P a = point(), c = point(), u = point();
    const P b = trial % 10 == 0 ? a : P(a + u), d = trial % 7 == 0 ? P(c + 0.7 * u) : point();
    double least = 1e9;
    for (int i = 0; i <= 200; ++i)
      for (int k = 0; k <= 200; ++k)
        least = std::min(least, (a + i / 200.0 * (b - a) - c - k / 200.0 * (d - c)).norm());
    const double exact = std::sqrt(squared_distance(a, b, c, d));
    EXPECT_LE(exact, least + 1e-12);
    EXPECT_NEAR(exact, least, 0.02);
  }
}

TEST(Surface, NearestPlacesOfATriangle) {
  const Simplex<3> t{P(0, 0, 0), P(2, 0, 0), P(0, 1, 0)};
  for (double x = -1; x <= 3; x += 0.37)
    for (double y = -1; y <= 2; y += 0.29) {
      const P p(x, y, 0.3), w = nearest_weights(p, t), at = w[0] * t[0] + w[1] * t[1] + w[2] * t[2];
      EXPECT_NEAR(w.sum(), 1, 1e-12);
      EXPECT_GE(w.minCoeff(), 0);
      EXPECT_NEAR((p - at).squaredNorm(), squared_distance(p, t), 1e-12) << x << " " << y;
    }
}

TEST(Surface, ItsPlacesAreCarriedAlong) {
  const Capsule was{P(0, 0, 0), P(1, 0, 0), 0.1}, is{P(0, 0.2, 0), P(1, 0.4, 0), 0.1};
  const Nearest n = nearest(P(0.5, 0.3, 1), std::span(&is, 1), std::span(&was, 1));
  EXPECT_NEAR(n.distance_m, 0.9, 1e-12);
  EXPECT_NEAR((n.normal - P(0, 0, 1)).norm(), 0, 1e-12);
  EXPECT_NEAR((n.carried_m - P(0, 0.3, 0)).norm(), 0, 1e-12);
  const std::vector<double> before{0, 0, 0, 1, 0, 0, 0, 1, 0}, now{0, 0, 1, 1, 0, 1, 0, 1, 2};
  const std::vector<std::array<std::uint32_t, 3>> one{{0, 1, 2}};
  const NearSurface surface({now, one});
  const auto found = surface(P(0.25, 0, 1.5), 10, before);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->carried_m[0], 0, 1e-12);
  EXPECT_NEAR(found->carried_m[2], 1.25, 1e-12) << "weights (1/2, 1/4, 1/4)";
  EXPECT_FALSE(surface(P(0.25, 0, 30), 10)) << "beyond the bound";
}

}  // namespace
}  // namespace clothbench::contact
