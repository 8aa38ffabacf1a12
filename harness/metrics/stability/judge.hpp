#pragma once
#include <optional>
#include <string>

#include "clothbench/record.hpp"
#include "metrics/metric.hpp"
#include "truth/reference_case.hpp"

namespace clothbench {

/// Classifies the frames of one run, in order, by its scene's rules; depends only on frames, scene and exact solution.
///
/// The energy gain compares visible energy (kinetic and gravitational) with the available energy: the energy at the
/// start, including elastic energy (from the strain, E = Y A e^2/2), plus the maximum work of hands and colliders. A
/// solver's elastic energy is not visible energy, because solvers without a modulus define none.
class StabilityJudge {
 public:
  explicit StabilityJudge(const Scene&);
  /// `truth`: empty if the scene names no exact solution.
  StabilityFrame judge(int frame, const ClothState&, const std::optional<TruthErrors>& truth);

  /// Physical bounds at the end of one frame, computed only from the scene. All bounds are deliberately generous: a run
  /// that exceeds them by the factors in judge.cpp is unstable, not only inaccurate.
  struct Bounds {
    double speed_m_per_s = 0;  ///< v_char: maximum of free fall, hands, colliders, start, strain times wave speed
    double jump_speed_m_per_s =
        0;                ///< last jump (a teleport, or a start that is not at rest) over its frame's duration; 0: none
    double strain = 0;    ///< maximum strain that loads, hands and colliders can cause; no prediction
    double work_J = 0;    ///< maximum work that hands and colliders can have done so far
    bool jumped = false;  ///< a hand, a collider or the start jumps in this frame
  };

 private:
  struct Strain {
    double mean, rms, greatest, p99;  ///< mean of |e|; the others keep the sign
  };
  Strain strain_of(const std::vector<double>& x) const;
  void judge_motion(int frame, const ClothState&, const Strain&, StabilityFrame&);
  void judge_strain(int frame, const Strain&, const std::optional<TruthErrors>& truth, StabilityFrame&);
  double visible_energy(const ClothState&) const;
  bool settled(int frame) const;

  const Scene& scene_;
  const std::vector<Bounds> bounds_;
  const std::vector<double> mass_, start_;
  std::vector<Edge> edges_;
  std::optional<truth::ReferenceCase> at_rest_;  ///< the scene's reference case if it describes a shape at rest
  double total_mass_ = 0, longer_m_ = 0, g_ = 0, stiffness_ = 0;
  bool relaxed_ = false, ever_relaxed_ = false;
  int stretched_frames_ = 0;
  double energy_base_J_ = 0, work_base_J_ = 0;
};

/// Result of a complete pass.
struct StabilityVerdict {
  enum class Grade { Stable, Degraded, Failed };
  Grade grade = Grade::Stable;
  std::string klass = "ok";  ///< class of the first frame with the worst grade
  int frame = -1;            ///< that frame
  std::string text() const;  ///< "degraded: F2 strain beyond the load"; not for a stable pass
};

/// From a pass's series `stability_classes`: failed by F0 or F1, degraded by F2.
StabilityVerdict stability_verdict(const AccuracyPass&);

}  // namespace clothbench
