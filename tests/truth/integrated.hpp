#pragma once
#include <boost/numeric/odeint.hpp>
#include <vector>

namespace clothbench::truth {

/// y' = f(y, dy, t) from `y` at 0 to `end`: what closed forms are checked against.
template <class F>
std::vector<double> integrated(std::vector<double> y, double end, F f) {
  namespace odeint = boost::numeric::odeint;
  using State = std::vector<double>;
  odeint::integrate_adaptive(odeint::make_controlled(1e-13, 1e-13, odeint::runge_kutta_fehlberg78<State>()), f, y, 0.0,
                             end, end / 100);
  return y;
}

}  // namespace clothbench::truth
