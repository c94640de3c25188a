#pragma once
// What is believed of a gyro's noise before its measurements are seen.
//
// Without a bound every smooth misfit is a random walk of some size. Published Allan curves bound
// it: of fiber-optic gyros from tactical to navigation grade, bias instability stands to white
// noise as B/N = 0.4..1.5 per sqrt(h), and no random walk shows within hours, K/N below about 0.6
// per h. So both ratios are taken as log-normal, B/N around 1 and K/N around 0.3, a factor of 5
// wide, and ten times what two such factors reach is not noise any more.

#include <string>

#include "config/result.hpp"
#include "config/scenario.hpp"

namespace fogbench::model {

struct NoiseEstimate;

class NoisePrior {
 public:
  /// The most probable value of a ratio, and the standard deviation of its decimal logarithm below
  /// it; above, the prior is twice as wide.
  struct Ratio {
    double median = 1.0;
    double decades = 0.7;

    /// log of the probability that the ratio is below `value`, and of its density per unit of the
    /// natural logarithm.
    double log_below(double value) const;
    double log_density(double value) const;
    /// Nine of ten such instruments stay below it.
    double usual_most() const;
    /// Beyond this it is a finding and not noise of such an instrument.
    double finding() const { return 10.0 * usual_most(); }
    /// What is not even tried: an estimate must be able to say that it is beyond.
    double most() const { return 30.0 * usual_most(); }
  };

  Ratio b_over_n{1.0, 0.7};    ///< per sqrt(h)
  Ratio k_over_n{0.316, 0.7};  ///< per h
  double least_white = 0.0;    ///< deg/sqrt(h), where N was given; else 0
  enum class Source { kInstruments, kGiven, kStaticRecord } source = Source::kInstruments;

  /// Of coefficients that a data sheet states; those that are zero are not stated. A unit's own
  /// numbers are taken to be within a factor of 2 of them.
  /// kBadInput: a coefficient is negative or no number, or N is not positive.
  static Result<NoisePrior> stated(const config::NoiseCoefficients& noise);
  /// Probability that the walk in this estimate is no finding.
  double walk_is_noise(const NoiseEstimate& estimate) const;
  /// Of what was estimated from a static record.
  static NoisePrior recorded(const NoiseEstimate& estimate);
};

}  // namespace fogbench::model
