// SPDX-License-Identifier: MIT
#include "emu/gpu/lps/lps.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "emu/gpu/lps/lps_kernel.h"
#include "emu/gpu/messages.h"

namespace cuboct::gpu {
namespace {

constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();
constexpr uint64_t kBatch = 256;  // steps between two looks for a position that is no number

template <class Real>
struct Fill {
  Real* to;
  Real value;
  CUBOCT_DEVICE void operator()(uint32_t i) const { to[i] = value; }
};

template <class Real>
std::vector<LpsKindOf<Real>> kinds_in(const std::vector<LpsKind>& kinds) {
  const auto real = [](double value) { return static_cast<Real>(value); };
  std::vector<LpsKindOf<Real>> out;
  for (const LpsKind& k : kinds)
    out.push_back({{real(k.r[0]), real(k.r[1]), real(k.r[2])},
                   real(k.length),
                   real(k.weight),
                   real(k.pull),
                   real(k.critical),
                   real(k.volume)});
  return out;
}

// The body as it begins, and what its types do, in the layout's units.
template <class Real>
struct LpsStart {
  std::vector<Four<Real, Real>> displaced;
  std::vector<Three<Real>> v;
  std::vector<Three<double>> packed;
  std::vector<LpsType<Real>> types;

  LpsStart(const Rule& rule, const Body& body, const std::vector<Vec3>& from, const LpsMaterial& material,
           const LpsUnits& units) {
    const double speed = units.length / units.time;
    for (size_t i = 0; i < body.size(); ++i) {
      const Three<Real> u = three((body.x[i] - from[i]) / units.length);
      displaced.push_back({{u.at[0], u.at[1], u.at[2]}, 0});
      v.push_back(three(body.v[i] / speed));
      packed.push_back({{from[i][0] / units.length, from[i][1] / units.length, from[i][2] / units.length}});
    }
    // Of a force density in units of pressure per length.
    const double kick = units.pressure * units.time / (units.length * speed) * material.volume;
    for (size_t t = 0; t < rule.types.size(); ++t) {
      const ParticleType& of = rule.types[t];
      LpsType<Real>& type = types.emplace_back();
      type.kick = static_cast<Real>(kick / rule.mass_of(static_cast<int>(t)));
      for (int a = 0; a < 3; ++a) {
        type.gravity[a] = static_cast<Real>(of.gravity[a] / speed * units.time);
        type.velocity[a] = static_cast<Real>(of.velocity[a] / speed);
        type.imposed |= (of.imposed[a] ? 1u : 0u) << a;
      }
    }
  }

 private:
  static Three<Real> three(const Vec3& from) {
    return {{static_cast<Real>(from[0]), static_cast<Real>(from[1]), static_cast<Real>(from[2])}};
  }
};

template <class Real, class Kind>
class LpsOn final : public LpsDevice {
 public:
  LpsOn(const Rule& rule, const Body& body, const std::vector<Vec3>& packed, const LpsTerms& terms,
        LpsLayout layout, const LpsOptions& options)
      : terms_(terms),
        layout_(std::move(layout)),
        options_(options),
        begin_(rule, body, packed, terms.material(), layout_.units),
        dt_(rule.dt),
        home_(packed),
        type_host_(body.type) {
    give_bonds();
    give_particles();
    start();
  }

  void start() override {
    step_ = 0;
    now_.set(stream_, begin_.displaced), v_.set(stream_, begin_.v);
    hurt_.zero(stream_);
    lost_.set(stream_, {kNone});
    if (most_.size() > 0)
      for_each(stream_, 0, static_cast<uint32_t>(most_.size()), options_.block,
               Fill<Real>{most_.data(), Real(-1)});
    stream_.synchronize();
  }

  void advance(uint64_t steps) override {
    while (steps > 0) {
      const uint64_t batch = std::min(steps, kBatch);
      for (uint64_t k = 0; k < batch; ++k) finite() ? step<true>() : step<false>();
      steps -= batch, step_ += batch;
      const uint32_t lost = lost_.host(stream_, 0, 1).front();
      if (lost != kNone) throw_lost_point(step_, lost);
    }
  }
  uint64_t step_count() const override { return step_; }

  LpsState state() override {
    finite() ? dilate<true>(false) : dilate<false>(false);
    LpsState state;
    const double speed = layout_.units.length / layout_.units.time;
    const std::vector<Four<Real, Real>> now = now_.host(stream_, 0, count());
    const std::vector<Three<Real>> v = v_.host(stream_, 0, count());
    for (size_t i = 0; i < count(); ++i) {
      state.x.push_back(home_[i] + layout_.units.length * vector_of(now[i].at));
      state.v.push_back(speed * vector_of(v[i].at));
    }
    state.dilatation = doubles(dilatation_);
    return state;
  }
  std::vector<double> damage() override {
    const LpsView<Real, Kind> view = view_of();
    for_each(stream_, 0, count(), options_.block, LpsDamage<Real, Kind>{view, dilatation_.data()});
    return doubles(dilatation_);
  }
  std::vector<uint64_t> memory() override {
    const std::vector<Real> most = most_.host(stream_, 0, most_.size());
    std::vector<uint64_t> words;
    if (most.empty()) return words;
    const ReferenceBonds& bonds = terms_.reference();
    for (size_t i = 0; i < count(); ++i)
      for (uint32_t k = 0; k < layout_.count[i]; ++k) {
        const bool breaks = terms_.breaks(bonds.begin(i) + k);
        const double here = static_cast<double>(most[layout_.slot(i, k)]);
        words.push_back(std::bit_cast<uint64_t>(breaks ? here : -std::numeric_limits<double>::infinity()));
      }
    return words;
  }
  size_t kinds() const override { return layout_.kinds.size(); }
  uint64_t device_bytes() const override { return bytes_; }

 private:
  bool finite() const { return terms_.material().finite; }
  uint32_t count() const { return static_cast<uint32_t>(home_.size()); }
  static Vec3 vector_of(const Real (&from)[3]) {
    return {static_cast<double>(from[0]), static_cast<double>(from[1]), static_cast<double>(from[2])};
  }
  std::vector<double> doubles(const Array<Real>& values) {
    std::vector<double> out;
    for (const Real value : values.host(stream_, 0, values.size())) out.push_back(static_cast<double>(value));
    return out;
  }

  void give_bonds() {
    kinds_.set(stream_, kinds_in<Real>(layout_.kinds));
    slice_.set(stream_, layout_.slice), number_.set(stream_, layout_.count),
        other_.set(stream_, layout_.other);
    kind_.set(stream_, std::vector<Kind>(layout_.kind.begin(), layout_.kind.end()));
    if (terms_.material().breaks()) most_.resize(layout_.slots());
    // Only slices and counts are asked for again.
    layout_.other = {}, layout_.kind = {};
  }
  void give_particles() {
    const double unit = layout_.units.length * layout_.units.length * layout_.units.volume;
    std::vector<Real> inverse;
    for (const double value : terms_.inverse_weighted()) inverse.push_back(static_cast<Real>(value * unit));
    inverse_.set(stream_, inverse);
    if constexpr (std::is_same_v<Real, double>) packed_.set(stream_, begin_.packed);
    type_.set(stream_, type_host_), types_.set(stream_, begin_.types);
    ready_.resize(count()), dilatation_.resize(count()), hurt_.resize(count());
  }

  LpsView<Real, Kind> view_of() const {
    const LpsMaterial& m = terms_.material();
    const auto real = [](double value) { return static_cast<Real>(value); };
    return {kinds_.data(),
            slice_.data(),
            number_.data(),
            other_.data(),
            kind_.data(),
            most_.data(),
            hurt_.data(),
            now_.data(),
            ready_.data(),
            v_.data(),
            packed_.data(),
            inverse_.data(),
            dilatation_.data(),
            type_.data(),
            types_.data(),
            lost_.data(),
            real(m.dimensions),
            real(m.dilatation_factor() / layout_.units.pressure),
            real(m.damage_width),
            real(dt_ / layout_.units.time),
            m.breaks()};
  }
  template <bool kFinite>
  void dilate(bool keeps) {
    for_each(stream_, 0, count(), options_.block, LpsDilate<Real, Kind, kFinite>{view_of(), keeps});
  }
  template <bool kFinite>
  void step() {
    dilate<kFinite>(true);
    for_each(stream_, 0, count(), options_.block, LpsMove<Real, Kind, kFinite>{view_of()});
  }

  const LpsTerms& terms_;
  LpsLayout layout_;
  const LpsOptions options_;
  const LpsStart<Real> begin_;
  const double dt_;
  const std::vector<Vec3> home_;
  const std::vector<uint8_t> type_host_;
  uint64_t step_ = 0, bytes_ = 0;
  Stream stream_{options_.device};
  template <typename T>
  struct OnDevice : Array<T> {
    explicit OnDevice(LpsOn& of) : Array<T>(of.options_.device, &of.bytes_) {}
  };
  OnDevice<LpsKindOf<Real>> kinds_{*this};
  OnDevice<uint32_t> slice_{*this}, number_{*this}, other_{*this}, lost_{*this};
  OnDevice<Kind> kind_{*this};
  OnDevice<Real> most_{*this}, inverse_{*this}, dilatation_{*this};
  OnDevice<uint8_t> hurt_{*this}, type_{*this};
  OnDevice<Four<Real, Real>> now_{*this}, ready_{*this};
  OnDevice<Three<Real>> v_{*this};
  OnDevice<Three<double>> packed_{*this};
  OnDevice<LpsType<Real>> types_{*this};
};

template <class Real>
std::unique_ptr<LpsDevice> make_in(const Rule& rule, const Body& body, const std::vector<Vec3>& packed,
                                   const LpsTerms& terms, LpsLayout layout, const LpsOptions& options) {
  if (layout.kinds.size() <= size_t{1} << 16)
    return std::make_unique<LpsOn<Real, uint16_t>>(rule, body, packed, terms, std::move(layout), options);
  return std::make_unique<LpsOn<Real, uint32_t>>(rule, body, packed, terms, std::move(layout), options);
}

}  // namespace

std::unique_ptr<LpsDevice> make_lps_device(const Rule& rule, const Body& body,
                                           const std::vector<Vec3>& packed, const LpsTerms& terms,
                                           const LpsOptions& options) {
  require_lps(rule, terms.material());
  LpsLayout layout = lps_layout(terms, rule.dt);
  const uint64_t real = options.doubles ? 8 : 4;
  require_lps_memory(options.device, body.size(), layout.slots() * (4 + 4 + real) + body.size() * 24 * real);
  if (options.doubles) return make_in<double>(rule, body, packed, terms, std::move(layout), options);
  return make_in<float>(rule, body, packed, terms, std::move(layout), options);
}

}  // namespace cuboct::gpu
