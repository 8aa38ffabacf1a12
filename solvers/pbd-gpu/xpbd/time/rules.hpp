#pragma once
#include <array>

// Every threshold by which a scene decides how it is integrated and how many substeps it takes: one row each, with its
// value, unit, reason and source. The pages of xpbd/time say how rows act together.

namespace clothbench::pbd_gpu {

/// A row. Code reads its value by the row's name.
template <class T>
struct Rule {
  T value;
  const char *unit, *reason, *source;
  constexpr operator T() const { return value; }
};
/// At `fast`, `default` and `accurate`.
using PerQuality = std::array<double, 3>;
/// Substeps of a frame: at least `smallest`, and one for so many links of the longer side.
struct LinkRule {
  PerQuality smallest, links_a_substep;
};

namespace rules {

using Value = Rule<double>;
using Count = Rule<int>;
using ByQuality = Rule<PerQuality>;
using Substeps = Rule<LinkRule>;

// clang-format off
// Second order in time, tension and the splitting correction (integrator.cpp).
inline constexpr Value kMaxStepRatio = {2, "of the last step",
    "a longer step begins anew: the history says little",
    "zero-stable below 1 + sqrt(2): Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I, III.5"};
inline constexpr Value kMaxWaveOfCloth = {0.6, "of the longer side, a substep",
    "above, a horizontal sheet released by two corners gains up to seven times the energy of backward Euler",
    "energy of released sheets"};
inline constexpr Value kMaxExplicitTension = {1.0 / 3, "h'^2 T / (m l)",
    "above, explicit tension throws a line aside", "stability of a line under tension (xpbd/time/README.md)"};
inline constexpr Value kMaxGripStrain = {0.5, "1",
    "hands that pull a sheet farther make its links overshoot: 12 % above the converged stretch, 3 % at order 1",
    "two-hand-stretch-10mps"};
inline constexpr Value kMaxSplittingCells = {6.9, "cells a wave crosses in h'",
    "above, a sheet leaves its modulus: squared, 100 within seconds, 52 in a minute, 47 never",
    "modulus of a patch of 65 x 17 vertices"};
inline constexpr Value kMaxSplittingOfSide = {1.15, "of the shorter side in h'",
    "above, what colours keep of one another feeds oscillations", "energy of small sheets"};
inline constexpr Value kMaxStiffnessTimesTension = {25, "h'^2 Y / m times h'^2 T / (m l)",
    "above, a sheet under tension gains energy: 39 is stable over 20 s, 81 grows",
    "33 x 33 vertices held by one corner"};
inline constexpr Count kMinSplittingLinks = {4, "links across", "fewer leave nothing to correct", "choice"};
inline constexpr Value kMaxSplittingOblong = {0.05, "of a cell's side",
    "the correction is derived for square cells", "xpbd/time/README.md"};
inline constexpr ByQuality kMaxSplittingSubsteps = {{6, 32, 64}, "substeps",
    "what a frame may cost for its modulus; n/6 if that is more", "choice of cost"};

// Substeps by what acts on the cloth: the first row that applies (substep_count.cpp). They are counted per frame,
// whatever its duration: a constant in seconds would differ between scaled copies of a scene.
inline constexpr Value kStiff = {1e4, "N/m",
    "from here on tethers carry the load, as in inextensible cloth", "scenes of hanging sheets"};
inline constexpr Substeps kTetheredStiff = {{{2, 6, 20}, {24, 12, 6}}, "substeps",
    "tethers carry the load", "error of hanging sheets by substeps"};
inline constexpr Substeps kTethered = {{{3, 5, 20}, {24, 12, 6}}, "substeps",
    "tethers bound the stretch", "error of hanging sheets by substeps"};
inline constexpr Substeps kStrip = {{{5, 10, 20}, {12, 6, 3}}, "substeps",
    "a line is solved exactly", "error of strips by substeps"};
inline constexpr Substeps kPinnedSheet = {{{5, 10, 20}, {6, 3, 1.5}}, "substeps",
    "colours leave error to one another", "error of sheets by substeps"};
inline constexpr Substeps kAttachedSheet = {{{10, 20, 40}, {6, 3, 1.5}}, "substeps",
    "attachments stretch a sheet", "two-hand-stretch"};
inline constexpr Substeps kKinematicContact = {{{4, 5, 20}, {8, 6, 1.5}}, "substeps",
    "a hand pushes in directions that tethers do not limit", "capsule-sweep"};
inline constexpr Substeps kKinematicContactChains = {{{5, 8, 20}, {6, 4, 1.5}}, "substeps",
    "chains of a mesh leave more error than grid lines", "strain of garments under capsules"};
inline constexpr Substeps kReleased = {{{4, 5, 20}, {8, 8, 6}}, "substeps",
    "what a hand has strained relaxes without contact",
    "strain at the end: with the substeps of free cloth 6 of 68 random runs fail"};
inline constexpr Substeps kResting = {{{8, 16, 32}, {4, 2, 1}}, "substeps",
    "much of the cloth is struck at once", "strain at impact and friction on edges"};
inline constexpr Substeps kRestingStrip = {{{8, 14, 28}, {12, 6, 3}}, "substeps",
    "a strip has no diagonals to strain", "capstan, incline"};
inline constexpr Substeps kNoContact = {{{3, 5, 20}, {1e9, 1e9, 1e9}}, "substeps",
    "nothing acts: any number is right", "choice"};
inline constexpr Value kManyLinks = {300, "links",
    "from here on links at pins have the largest error at `fast`", "stretch at the pins of fine sheets"};
inline constexpr Value kManyLinksFactor = {1.2, "1",
    "as above: n/20 in place of n/24", "stretch at the pins of fine sheets"};
inline constexpr Value kLayersFactor = {1.5, "1",
    "a heap of the cloth's own layers slides on for long otherwise",
    "a heap of 32 x 32 vertices slides for a second at 16, and lies at 24"};
inline constexpr Value kMaxSwing = {0.15, "dt sqrt(g / L)",
    "what gravity moves farther in a frame counts as several frames", "strips and sheets under strong gravity"};
inline constexpr ByQuality kMaxSlidingStep = {{0.005, 0.0025, 0.00125}, "h sqrt(g / L)",
    "a sliding strip is first order in time: within 3 % at the first", "Atwood's rope on a cylinder"};

// Substeps by speed in contact (substep_count.cpp). Nothing is passed with any number, so the maxima are of cost.
inline constexpr ByQuality kTravelMargins = {{2, 1, 0.5}, "contact offsets, a substep",
    "a struck vertex pulls its neighbours along before links overstretch", "strain of drawn scenes of contact"};
inline constexpr ByQuality kFasterOnImpact = {{1, 2, 1}, "1",
    "divides the travel of fast impacts: strain grows with speed", "strain of drawn scenes of contact"};
inline constexpr Value kFastTravel = {8, "travels a frame",
    "from here on motion counts as faster", "strain of drawn scenes of contact"};
inline constexpr Value kMinMarginOfCell = {0.125, "cells",
    "a thin offset does not ask for more substeps than this", "choice of cost"};
inline constexpr Value kMaxTravelOnImpact = {0.25, "cells",
    "on static shapes much of the cloth is struck at once", "strain of drawn scenes of contact"};
inline constexpr Value kMaxLayerApproach = {2.0 / 3, "thicknesses, a substep",
    "responses cannot part layers that approach farther; planes cut their motion", "xpbd/contact/README.md"};
inline constexpr Value kUsersHand_m_per_s = {2, "m/s",
    "a live session does not know its hand's speed, and a replay must take as many substeps", "usual hand motion"};
inline constexpr ByQuality kMaxForSpeed = {{16, 32, 64}, "substeps",
    "what a frame may cost", "choice of cost"};
inline constexpr ByQuality kMaxForImpact = {{32, 96, 96}, "substeps",
    "the same of free cloth on static colliders", "choice of cost"};

// Substeps by the last frame (SubstepController).
inline constexpr Value kMinOfLast = {0.75, "of the last frame's",
    "the strain of an impact relaxes in the frames after it", "strain of drawn scenes of contact"};
inline constexpr Count kSubstepGrain = {4, "substeps",
    "a frame is not recorded anew each time", "choice of cost"};
inline constexpr Value kQuiescent = {1.0 / 24, "cells a frame",
    "below for some frames, the cloth rests", "cloth at rest on a desk gives by 1 mm when the number changes"};
inline constexpr Value kMoves = {1.0 / 6, "cells a frame",
    "above, all substeps come back; apart from kQuiescent, so that the number does not oscillate",
    "cloth at rest on a desk gives by 1 mm when the number changes"};
inline constexpr Count kQuiescentFrames = {4, "frames",
    "a turning point is not rest", "cloth at rest on a desk gives by 1 mm when the number changes"};
inline constexpr Count kMaxHalvings = {2, "halvings",
    "fewer substeps leave more strain", "cloth at rest on a desk gives by 1 mm when the number changes"};

// Long frames and crumpled starts (solver.cpp).
inline constexpr Value kLongFrame = {1.25, "of the scene's frame", "jitter is no hitch", "choice"};
inline constexpr Value kMaxLongFrame_s = {1, "s",
    "in a longer frame the simulation itself has fallen behind", "choice"};
inline constexpr Count kCrumpledFactor = {4, "1",
    "with fewer substeps a crumpled start takes longer than 1 s to open", "crumpled starts of scenarios/stability"};
// clang-format on

}  // namespace rules
}  // namespace clothbench::pbd_gpu
