#pragma once
#include <optional>
#include <string>

#include "clothbench/record.hpp"
#include "metrics/metric.hpp"
#include "truth/reference_case.hpp"

namespace clothbench {

struct TruthErrors;

namespace stability {

/// Physical bounds at the end of one frame, computed only from the scene. All bounds are generous by design: a run that
/// exceeds them by the factors below is not inaccurate but unstable.
struct Bounds {
  double speed_m_per_s = 0;  ///< v_char: max of free fall, hands, colliders, the start, and strain times wave speed
  double jump_speed_m_per_s =
      0;                ///< of the last jump (a teleport, a start that is not at rest), over its frame; 0 = none yet
  double strain = 0;    ///< maximum strain that loads, hands and colliders can cause (not a prediction)
  double work_J = 0;    ///< maximum work that hands and colliders can have done so far
  bool jumped = false;  ///< something jumped in this frame
};

/// The bounds of every frame, 0 = the start.
///
/// Free fall: sqrt(2 g H), H = twice the diagonal for held cloth, g t^2/2 plus the diagonal for free cloth. Waves: a
/// strain e travels at c = sqrt(Y/rho) with particle speed e c. The static strain is M g/(Y w), w the shorter side, and
/// twice that for sudden loads. Added to it are 3 v/c for hands (the wave and its first reflections), 2 v/c for
/// colliders, and v/c for cloth that falls slack and is stopped suddenly.
std::vector<Bounds> envelope(const Scene&);

/// Maximum membrane stiffness of the scene [N/m]; 0 = inextensible.
double greatest_stiffness(const Scene&);

// Thresholds of the outcome classes, all chosen for this project; published work rarely states its own.
inline constexpr double kSpeed = 10;        ///< F0: times v_char
inline constexpr double kGain = 0.1;        ///< F1: energy gained over M g L
inline constexpr double kStrain = 0.10;     ///< F2: maximum strain beyond the truth, for more than ...
inline constexpr int kStrainFrames = 3;     ///< ... so many frames in a row
inline constexpr double kStrainP99 = 0.05;  ///< F2: 99th percentile, in any frame
inline constexpr double kTorn = 1;          ///< F2: strain beyond the truth in any frame
inline constexpr double kRelaxed = 0.01;    ///< mean |strain| below which F1 and F2 start to count, where delayed
inline constexpr double kQuantity = 0.02, kQuantityLength = 1e-3;  ///< F2 at the end: error of the quantity at rest

}  // namespace stability

/// Outcome classes of one frame: F0 not finite or unbounded, F1 energy gained, F2 strain beyond the load. (The runner
/// sets F3, budget and device.) Its numbers are compared with the thresholds above. NaN: not defined for the scene, or
/// not judged yet.
struct StabilityFrame {
  unsigned classes = 0;             ///< bit k: Fk, only classes that the scene judges
  double speed = kMissing;          ///< maximum vertex speed over v_char
  double energy_gain = kMissing;    ///< over M g L (M v_char^2 without gravity)
  double strain_excess = kMissing;  ///< maximum
  /// Whether the run cannot recover.
  bool lost() const { return (classes & 3u) != 0; }
};

/// Judges the frames of one run, in order, by its scene's rules: a pure function of frames, scene and truth.
///
/// The energy gain compares visible energy (kinetic and gravitational) with the available energy: the energy at the
/// start, including elastic energy (from the strain, E = Y A e^2/2), and the maximum work of hands and colliders. The
/// elastic energy of a solver's model does not count as visible, because solvers without a modulus have none.
class StabilityJudge {
 public:
  explicit StabilityJudge(const Scene&);
  StabilityFrame judge(int frame, const ClothState&, const TruthErrors*);

 private:
  struct Strain {
    double mean, rms, greatest, p99;  ///< mean of |e|; the others signed
  };
  Strain strain_of(const std::vector<double>& x) const;
  void judge_motion(int frame, const ClothState&, const Strain&, StabilityFrame&);
  void judge_strain(int frame, const Strain&, const TruthErrors*, StabilityFrame&);
  double visible_energy(const ClothState&) const;
  bool settled(int frame) const;

  const Scene& scene_;
  const std::vector<stability::Bounds> bounds_;
  const std::vector<double> mass_, start_;
  const std::vector<Edge> edges_;
  std::optional<truth::ReferenceCase> at_rest_;  ///< the scene's reference case if it describes a shape at rest
  double total_mass_ = 0, longer_m_ = 0, g_ = 0, stiffness_ = 0;
  bool relaxed_ = false, ever_relaxed_ = false;
  int stretched_frames_ = 0;
  double energy_base_J_ = 0, work_base_J_ = 0;
};

/// The rating of a whole pass.
struct StabilityVerdict {
  enum class Grade { Stable, Degraded, Failed };
  Grade grade = Grade::Stable;
  std::string klass = "ok";  ///< class of the first frame with the worst grade
  int frame = -1;            ///< that frame
};

/// From a pass's series `stability_classes`: failed by F0 or F1, degraded by F2.
StabilityVerdict stability_verdict(const AccuracyPass&);

const char* name_of(StabilityVerdict::Grade);

/// Label of a class: "F1 energy gained".
std::string class_name(int k);

}  // namespace clothbench
