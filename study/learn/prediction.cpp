// SPDX-License-Identifier: MIT
#include "study/learn/prediction.h"

#include <algorithm>
#include <cmath>

namespace cuboct::learn {
namespace {

// Semi-implicit Euler, which is central differences with velocities half a step behind.
class Walk {
 public:
  Walk(const CrackData& data, CrackBody& body, double interval, const PredictionInput& input)
      : data_(data), body_(body), u_(data.frames[0].u), v_(data.velocity), held_(u_.size(), 1) {
    for (const size_t i : inside(data.grid, input.collar)) held_[i] = 0;
    const double step = input.dt * body.stable_step(*std::ranges::min_element(data.density));
    steps_ = static_cast<int>(std::ceil(interval / step));
    dt_ = interval / steps_;
    kick(0, 0, dt_ / 2);
  }
  // From frame - 1 to frame.
  void to(size_t frame) {
    for (int step = 0; step < steps_; ++step) {
      for (size_t i = 0; i < u_.size(); ++i) u_[i] += dt_ * v_[i];
      const double along = static_cast<double>(step + 1) / steps_;
      hold(frame, along);
      kick(frame, along, dt_);
    }
  }
  const std::vector<Vec3>& u() const { return u_; }

 private:
  // Between two frames.
  Vec3 mixed(std::vector<Vec3> Frame::*field, size_t frame, double along, size_t i) const {
    const Vec3& now = (data_.frames[frame].*field)[i];
    return frame == 0 ? now : Vec3(now + (1 - along) * ((data_.frames[frame - 1].*field)[i] - now));
  }
  void hold(size_t frame, double along) {
    for (size_t i = 0; i < u_.size(); ++i)
      if (held_[i]) u_[i] = mixed(&Frame::u, frame, along, i);
  }
  void kick(size_t frame, double along, double dt) {
    const std::vector<Vec3>& force = body_.force(u_, true);
    for (size_t i = 0; i < u_.size(); ++i)
      if (!held_[i])
        v_[i] += dt / data_.density[i] * (force[i] + mixed(&Frame::b, frame, along, i));
      else
        v_[i].setZero();
  }

  const CrackData& data_;
  CrackBody& body_;
  std::vector<Vec3> u_, v_;
  std::vector<char> held_;
  int steps_ = 0;
  double dt_ = 0;
};

}  // namespace

std::vector<size_t> inside(const Grid& grid, double collar) {
  std::vector<size_t> out;
  for (size_t k = 0; k < grid.size(); ++k) {
    const Vec3 x = grid.at(k);
    bool free = true;
    for (int a = 0; a < 2; ++a) free &= std::abs(x[a]) < (grid.points / 2.0 - collar) * grid.spacing[a];
    if (free) out.push_back(k);
  }
  return out;
}

std::vector<CrackState> seen(const CrackData& data, const Kernel& kernel, const Breaking& breaking,
                             double slit) {
  CrackBody body(data.grid, kernel, breaking, slit);
  std::vector<CrackState> out;
  for (const Frame& frame : data.frames) {
    body.force(frame.u, true);
    out.push_back({frame.u, body.damage()});
  }
  return out;
}

std::vector<CrackState> predict(const CrackData& data, const Kernel& kernel, const Breaking& breaking,
                                double slit, double interval, const PredictionInput& input) {
  CrackBody body(data.grid, kernel, breaking, slit);
  Walk walk(data, body, interval, input);
  std::vector<CrackState> out{{walk.u(), body.damage()}};
  for (size_t frame = 1; frame < data.frames.size(); ++frame) {
    walk.to(frame);
    out.push_back({walk.u(), body.damage()});
  }
  return out;
}

CrackErrors errors_of(const std::vector<CrackState>& predicted, const std::vector<CrackState>& seen,
                      const std::vector<size_t>& points) {
  CrackErrors errors;
  const auto frames = static_cast<double>(seen.size() - 1);
  for (size_t frame = 1; frame < seen.size(); ++frame) {
    double off = 0, size = 0, off_damage = 0, size_damage = 0;
    for (const size_t i : points) {
      off += (predicted[frame].u[i] - seen[frame].u[i]).squaredNorm();
      size += seen[frame].u[i].squaredNorm();
      off_damage += std::pow(predicted[frame].damage[i] - seen[frame].damage[i], 2);
      size_damage += std::pow(seen[frame].damage[i], 2);
    }
    errors.displacement += std::sqrt(off / size) / frames;
    errors.damage += std::sqrt(off_damage / size_damage) / frames;
    errors.displacement_squares += off / size / frames;
    errors.damage_squares += off_damage / size_damage / frames;
  }
  return errors;
}

double stretch_residual(const CrackData& data, const Kernel& kernel, const Breaking& breaking, double slit,
                        const std::array<int, 2>& frames, const std::vector<size_t>& points) {
  CrackBody body(data.grid, kernel, breaking, slit);
  double off = 0, size = 0;
  for (int frame = 0; frame <= frames[1]; ++frame) {
    const Frame& now = data.frames[static_cast<size_t>(frame)];
    const std::vector<Vec3>& force = body.force(now.u, true);
    if (frame < frames[0]) continue;
    for (const size_t i : points) {
      const Vec3 inertia = data.density[i] * now.acceleration[i] - now.b[i];
      off += (inertia - force[i]).squaredNorm(), size += inertia.squaredNorm();
    }
  }
  return std::sqrt(off / size);
}

}  // namespace cuboct::learn
