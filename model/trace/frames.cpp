// SPDX-License-Identifier: MIT
#include "model/trace/frames.h"

#include <fmt/compile.h>
#include <fmt/format.h>
#include <zlib.h>

#include <array>
#include <cmath>
#include <iterator>
#include <new>

#include "model/base/error.h"
#include "model/base/text.h"
#include "model/base/units.h"

namespace cuboct {

struct FrameText::Packer {
  Packer() {
    // 16 + the window's bits: with gzip's head. Neither time nor name stands in it.
    if (deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY) != Z_OK)
      throw std::bad_alloc();
  }
  ~Packer() { deflateEnd(&stream); }
  Packer(const Packer&) = delete;
  Packer& operator=(const Packer&) = delete;

  void add(const char* text, size_t size, int flush, GrowingFile& to) {
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text));
    stream.avail_in = static_cast<uInt>(size);
    do {
      stream.next_out = reinterpret_cast<Bytef*>(out.data());
      stream.avail_out = static_cast<uInt>(out.size());
      deflate(&stream, flush);
      to.write(out.data(), out.size() - stream.avail_out);
    } while (stream.avail_out == 0);
  }

  z_stream stream{};
  std::array<char, 1 << 16> out{};
};

FrameText::FrameText(const std::string& path, bool packed)
    : file_(path), packer_(packed ? std::make_unique<Packer>() : nullptr) {}
FrameText::~FrameText() = default;

void FrameText::write(const char* text, size_t size) {
  if (!packer_) return file_.write(text, size);
  try {
    packer_->add(text, size, Z_NO_FLUSH, file_);
  } catch (const InputError&) {
    deflateReset(&packer_->stream);  // the frame's beginning is gone from the file
    throw;
  }
}

void FrameText::commit() {
  if (packer_) {
    const auto begin_anew = [&] { deflateReset(&packer_->stream); };
    try {
      packer_->add(nullptr, 0, Z_FINISH, file_);
    } catch (const InputError&) {
      begin_anew();
      throw;
    }
    begin_anew();
  }
  file_.commit();
}

namespace {

constexpr size_t kTextBlock = 1 << 16;

// line(out, i) for each particle, in pieces.
template <typename Line>
void write_lines(FrameText& file, fmt::memory_buffer& out, size_t count, Line line) {
  for (size_t i = 0; i < count; ++i) {
    line(std::back_inserter(out), i);
    if (out.size() < kTextBlock) continue;
    file.write(out.data(), out.size());
    out.clear();
  }
  file.write(out.data(), out.size());
  file.commit();
}

// The field's numbers of a particle, each behind a blank. `exact`: as many digits as give it back.
template <typename Out>
void write_numbers(Out to, const FrameField& field, const Frame& frame, size_t i, bool exact = false) {
  for (size_t c = 0; c < field.numbers(); ++c) {
    const double value = field.value(frame, i, c);
    if (field.whole)
      fmt::format_to(to, FMT_COMPILE(" {}"), static_cast<uint64_t>(value));
    else if (exact)
      fmt::format_to(to, FMT_COMPILE(" {}"), value);
    else
      fmt::format_to(to, FMT_COMPILE(" {:.6g}"), value);
  }
}

// Scales a field, and says so in its unit.
void convert(FrameField& field, const std::string& name, const std::string& unit,
             const std::function<double(const Frame&, size_t particle)>& factor) {
  field.name = name, field.unit = unit;
  field.value = [value = std::move(field.value), factor](const Frame& frame, size_t i, size_t c) {
    return value(frame, i, c) * factor(frame, i);
  };
}

double si(const char* unit) { return parse_quantity(std::string("1 ") + unit).values[0]; }

// In ASE's units (ase.units: eV, angstrom and u are 1).
void convert_to_ase(std::vector<FrameField>& fields, const std::vector<FrameType>& types) {
  const double u = si("u"), momentum = std::sqrt(u * si("eV")), length = si("angstrom");
  std::vector<double> masses;
  for (const FrameType& type : types) masses.push_back(type.mass);
  const auto mass = [masses](const Frame& frame, size_t i) { return masses[frame.type[i]]; };
  for (FrameField& field : fields) {
    if (field.name == "radius")
      convert(field, "radius", "angstrom", [length](const Frame&, size_t) { return 1 / length; });
    if (field.name == "velocity")
      convert(field, "momenta", "sqrt(u*eV)",
              [mass, momentum](const Frame& frame, size_t i) { return mass(frame, i) / momentum; });
  }
  fields.push_back({"masses", "u", {}, false, [mass, u](const Frame& frame, size_t i, size_t) {
                      return mass(frame, i) / u;
                    }});
}

}  // namespace

XyzWriter::XyzWriter(const std::string& path, const FrameStyle& style, const XyzForm& form)
    : style_(style), fields_(frame_fields(style)), exact_(form.exact), file_(path, form.packed) {
  if (form.exact) std::erase_if(fields_, [](const FrameField& field) { return field.name != "velocity"; });
  if (form.ase) {
    length_ = 1 / si("angstrom");
    convert_to_ase(fields_, style.types);
  }
  for (FrameField& field : fields_)
    if (field.name == "velocity") field.name = "velo";  // OVITO's word
  for (size_t k = 0; k < style.types.size(); ++k) {
    const FrameType& type = style.types[k];
    species_.push_back(type.species);
    words_.push_back(fmt::format("{} {} {}", k, xyz_word(type.material),
                                 type.constraint.empty() ? "-" : xyz_word(type.constraint)));
  }
  const std::string length = form.ase ? "angstrom" : unit_text(style, "m");
  head_ = "Properties=species:S:1:pos:R:3:id:I:1:type_index:I:1:material:S:1:constraint:S:1";
  std::string units =
      fmt::format("Time:{} Lattice:{} Origin:{} pos:{}", unit_text(style, "s"), length, length, length);
  for (const FrameField& field : fields_) {
    head_ += fmt::format(":{}:{}:{}", field.name, field.whole ? 'I' : 'R', field.numbers());
    units += fmt::format(" {}:{}", field.name, unit_text(style, field.unit));
  }
  head_ += " units=\"" + units + "\"";
}

void XyzWriter::add(const Frame& frame) {
  const FrameBox box = box_of(frame, style_);
  const auto flag = [&](int axis) { return style_.periodic.extent[axis] > 0 ? 'T' : 'F'; };
  const Vec3 extent = length_ * box.extent, lower = length_ * box.lower;
  fmt::memory_buffer out;
  const auto three = [&](const Vec3& v, const char* between) {
    return exact_ ? fmt::format("{}{}{}{}{}", v[0], between, v[1], between, v[2])
                  : fmt::format("{:.9g}{}{:.9g}{}{:.9g}", v[0], between, v[1], between, v[2]);
  };
  fmt::format_to(std::back_inserter(out),
                 "{}\nLattice=\"{}\" Origin=\"{}\" pbc=\"{} {} {}\" {} Step={} Time={:.9g}\n", frame.x.size(),
                 three(extent, " 0 0 0 "), three(lower, " "), flag(0), flag(1), flag(2), head_, frame.step,
                 frame.time);
  write_lines(file_, out, frame.x.size(), [&](auto to, size_t i) {
    const Vec3 x = length_ * frame.x[i];
    if (exact_)
      fmt::format_to(to, FMT_COMPILE("{} {} {} {} {} {}"), species_[frame.type[i]], x[0], x[1], x[2], i,
                     words_[frame.type[i]]);
    else
      fmt::format_to(to, FMT_COMPILE("{} {:.9g} {:.9g} {:.9g} {} {}"), species_[frame.type[i]], x[0], x[1],
                     x[2], i, words_[frame.type[i]]);
    for (const FrameField& field : fields_) write_numbers(to, field, frame, i, exact_);
    *to++ = '\n';
  });
}

LammpsWriter::LammpsWriter(const std::string& path, const FrameStyle& style)
    : style_(style), fields_(frame_fields(style)), columns_("id type x y z"), file_(path, true) {
  for (const FrameField& field : fields_) {
    if (field.components.empty()) columns_ += " " + field.name;
    for (const std::string& component : field.components)
      columns_ += field.name == "velocity" ? " v" + component : " " + field.name + "_" + component;
  }
}

void LammpsWriter::add(const Frame& frame) {
  const FrameBox box = box_of(frame, style_);
  fmt::memory_buffer out;
  const auto to = std::back_inserter(out);
  fmt::format_to(to, "ITEM: UNITS\n{}\nITEM: TIME\n{:.9g}\nITEM: TIMESTEP\n{}\nITEM: NUMBER OF ATOMS\n{}\n",
                 style_.reduced ? "lj" : "si", frame.time, frame.step, frame.x.size());
  std::string ends;
  for (int axis = 0; axis < 3; ++axis) ends += style_.periodic.extent[axis] > 0 ? " pp" : " ff";
  fmt::format_to(to, "ITEM: BOX BOUNDS{}\n", ends);
  for (int axis = 0; axis < 3; ++axis)
    fmt::format_to(to, "{:.9g} {:.9g}\n", box.lower[axis], box.lower[axis] + box.extent[axis]);
  fmt::format_to(to, "ITEM: ATOMS {}\n", columns_);
  write_lines(file_, out, frame.x.size(), [&](auto line, size_t i) {
    const Vec3& x = frame.x[i];
    fmt::format_to(line, FMT_COMPILE("{} {} {:.9g} {:.9g} {:.9g}"), i + 1, frame.type[i] + 1, x[0], x[1],
                   x[2]);
    for (const FrameField& field : fields_) write_numbers(line, field, frame, i);
    *line++ = '\n';
  });
}

}  // namespace cuboct
