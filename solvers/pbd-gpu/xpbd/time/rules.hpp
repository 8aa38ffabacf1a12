#pragma once
#include <array>
#include <cstdint>

// All thresholds that decide a scene's integration and number of substeps, each with [unit], reason and (source). A
// value without source is a choice. xpbd/time/README.md describes how they act together.

namespace clothbench::pbd_gpu {

/// One value each for `fast`, `default` and `accurate`.
using PerQuality = std::array<double, 3>;
/// Substeps per frame: the links along the longer side divided by `links_a_substep`, at least `smallest`.
struct LinkRule {
  PerQuality smallest, links_a_substep;
};

namespace rules {

// Second order in time, tension and the splitting correction (integrator.cpp).
// [last steps] A longer step restarts BDF2, which is zero-stable only for ratios below 1 + sqrt(2) (Hairer, Norsett &
// Wanner, Solving Ordinary Differential Equations I, III.5)
inline constexpr double kMaxStepRatio = 2;
// [longer sides a wave crosses per substep] Above, a sheet that starts horizontal, held at two corners, gains up to
// seven times backward Euler's energy (energy of released sheets)
inline constexpr double kMaxWaveOfCloth = 0.6;
// [h'^2 T / (m l)] Above, explicit tension throws a line aside (xpbd/time/README.md)
inline constexpr double kMaxExplicitTension = 1.0 / 3;
// [relative increase of the attachments' distance] Above, links of a sheet overshoot the converged stretch: by 12 % at
// order 2, 3 % at order 1 (two-hand-stretch-10mps)
inline constexpr double kMaxGripStrain = 0.5;
// [cells a wave crosses in h'] Above, a sheet's modulus drifts: within seconds if the square of this number is 100,
// within a minute if it is 52, never if it is 47 (modulus of a patch of 65 x 17 vertices)
inline constexpr double kMaxSplittingCells = 6.9;
// [the same] Above, a sheet that hangs in folds from one vertex gains energy (sheets of `energy`)
inline constexpr double kMaxSplittingCellsOfFolds = 1.5;
// [shorter sides a wave crosses in h'] Above, the delayed correction excites oscillations (energy of small sheets)
inline constexpr double kMaxSplittingOfSide = 1.15;
// [h'^2 Y / m times h'^2 T / (m l)] Above, a sheet under tension gains energy: 39 is stable over 20 s, 81 grows (33 x
// 33 vertices held by one corner)
inline constexpr double kMaxStiffnessTimesTension = 25;
inline constexpr int kMinSplittingLinks = 4;  // [links across] With fewer there is nothing to correct
// [relative difference of a cell's sides] The correction is derived for square cells (xpbd/time/README.md)
inline constexpr double kMaxSplittingOblong = 0.05;
// [substeps] Maximum cost of a frame for the correct modulus, or links along the longer side / 6 if that is more
inline constexpr PerQuality kMaxSplittingSubsteps = {6, 32, 64};

// Substeps by what acts on the cloth: the first row that applies (substep_count.cpp). They are counted per frame,
// whatever its duration: a constant in seconds would differ between scaled copies of a scene. Source unless stated: the
// error as a function of the substeps in hanging sheets and strips without contact, and the strain in contact.
inline constexpr LinkRule kTethered = {{2, 6, 20}, {24, 12, 6}};  // Tethers bound the stretch
inline constexpr LinkRule kStrip = {{5, 10, 20}, {12, 6, 3}};     // A line is solved exactly
// Below, waves that attachments send along a strip lose their crests (pull at random parameters)
inline constexpr LinkRule kPulledStrip = {{10, 28, 40}, {12, 6, 3}};
inline constexpr LinkRule kPinnedSheet = {{5, 10, 20}, {6, 3, 1.5}};     // Each colour disturbs the others
inline constexpr LinkRule kAttachedSheet = {{10, 20, 40}, {6, 3, 1.5}};  // Attachments stretch a sheet
// Attachments pull a sheet apart by more than kMaxGripStrain. With a fifth of these substeps, long links turn so far in
// one that corrections change the angular momentum (motion check of random pulls in the study `contact`)
inline constexpr LinkRule kPulledSheet = {{80, 100, 200}, {0.75, 0.6, 0.3}};
// A collider strains the cloth in directions that tethers do not limit (capsule-sweep)
inline constexpr LinkRule kKinematicContact = {{4, 5, 20}, {6, 6, 1.5}};
// Chains of a mesh are less accurate than grid lines (garments under capsules)
inline constexpr LinkRule kKinematicContactChains = {{5, 8, 20}, {6, 4, 1.5}};
// Contact-free frames after a collider has strained the cloth: with free cloth's rules 6 of 68 random runs fail
inline constexpr LinkRule kReleased = {{4, 5, 20}, {8, 8, 6}};
inline constexpr LinkRule kOnColliders = {{12, 16, 32}, {2.67, 2, 1}};  // Much of the cloth hits the collider at once
// While no link of such a sheet exceeds kMaxStrain
inline constexpr LinkRule kSlowOnColliders = {{9, 12, 24}, {5.33, 4, 2}};
inline constexpr LinkRule kNoContact = {{3, 5, 20}, {1e9, 1e9, 1e9}};  // Nothing strains the cloth: any number will do
// [iterations per substep] A mesh that needs more is solved by chains, which can stretch far too much under its weight
inline constexpr std::uint32_t kMaxMembraneIterations = 600;
// [factor] Maximum increase of the substeps so that fewer iterations suffice (heavy-strip-mesh in `physics`)
inline constexpr int kMaxForMembrane = 2;
// With fewer substeps a heap of layers keeps sliding: with 32 x 32 vertices, for a second at 16 substeps, not at 24
inline constexpr double kLayersFactor = 1.5;
// [dt sqrt(g / L)] Above, more substeps: at 100 g a strip would gain energy, and small sheets would slide too far
inline constexpr double kMaxSwing = 0.08;
// [h sqrt(g / L)] A sliding strip is first order in time: error within 3 % at `fast` (Atwood's rope on a cylinder)
inline constexpr PerQuality kMaxSlidingStep = {0.005, 0.0025, 0.00125};
// [substeps of the first frame / of later ones] A strip laid on a collider starts without tension, and slides freely
// for the few substeps in which tension builds up (capstan-slip at random parameters)
inline constexpr int kStartFactor = 4;

// Substeps by speed in contact (substep_count.cpp). Separating planes do not need them, so the maxima only limit cost.
// [contact offsets per substep] Up to this, a vertex that is hit pulls its neighbours along before links overstretch
// (strain of random contact scenes)
inline constexpr PerQuality kTravelMargins = {0.9, 0.7, 0.5};
// [thicknesses per substep] Layers may approach by this. Without a limit the pairs of fast layers overflow their list
inline constexpr double kMaxLayerApproach = 2;
// [m/s] Assumed, because a live session does not know its hand's speed, and a replay must use the same substeps
inline constexpr double kUsersHand_m_per_s = 2;
// Maximum cost of a frame. Links per substep: only for sheets that hit static colliders
inline constexpr LinkRule kImpact = {{32, 48, 64}, {1.5, 1, 1}};

// Substeps by the last frame (SubstepController). When their number changes, cloth at rest on a desk moves by 1 mm.
// [strain of a link at the end of a frame] Above, half as many substeps more in the next one, up to the table's number.
// Sheets that drape may strain links by a tenth (strict contact, scenarios/README.md)
inline constexpr PerQuality kMaxStrain = {0.1, 0.08, 0.03};
inline constexpr double kFewerBelow = 0.75;  // [of kMaxStrain] Below, fewer again
// [the same] Above, the frame is repeated with twice the substeps, as an adaptive integrator rejects a step
// (Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I, II.4). Impacts may strain links by half
inline constexpr PerQuality kRepeatStrain = {0.3, 0.25, 0.1};
// [strain over that of the attempt before] Above, more substeps do not help: the material is soft
inline constexpr double kWorthRepeating = 0.75;
inline constexpr double kToleratedGrowth = 1.5;  // [of the strain where they did not help] Up to this, no repeats
inline constexpr double kQuiescent = 1.0 / 24;   // [cells per frame] Below this for kQuiescentFrames, cloth is at rest
// [cells per frame] Above, halvings end; larger than kQuiescent, so that the number does not oscillate
inline constexpr double kMoves = 1.0 / 6;
inline constexpr int kQuiescentFrames = 4;  // [frames] In fewer frames, cloth may only pass a turning point
inline constexpr int kMaxHalvings = 2;      // [halvings of the table's number] Fewer substeps leave more strain

// [cells] Maximum motion per list of pairs with static colliders: above, a desk holds back cloth beside it
// (contact-11204631-desk)
inline constexpr double kCellsPerList = 2;
inline constexpr int kMinSubstepsPerList = 4;  // [substeps] A list costs as much as one or two

// Long frames and crumpled starts (solver.cpp).
inline constexpr double kLongFrame = 1.25;    // [of the scene's frame] Below, it is jitter and not a hitch
inline constexpr double kMaxLongFrame_s = 1;  // [s] In a longer frame the simulation itself has fallen behind
// With fewer substeps a crumpled start takes longer than 1 s to open (crumpled starts of scenarios/stability)
inline constexpr int kCrumpledFactor = 4;

}  // namespace rules
}  // namespace clothbench::pbd_gpu
