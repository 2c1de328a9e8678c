// SPDX-License-Identifier: MIT
// Values are numbered by what they are. A value is a linear form over atoms, so that sums are compared
// however they were added up; an atom is the number 1, an input, or the value of an operation that is not
// linear. An operation that is odd in its arguments is numbered for one sign of them. Numbered again with own
// and other swapped, an even value has the same form and an odd one its negative.
#include "model/graph/parity.h"

#include <map>

#include "model/graph/interval.h"

namespace cuboct::graph {
namespace {

using Form = std::map<int, Wide>;  // coefficient of each atom; none is 0
using Key = std::vector<Wide>;

constexpr int kOne = 0;  // the atom that is the number 1

void add_to(Form& form, const Form& other, Wide times) {
  for (const auto& [atom, coefficient] : other)
    if ((form[atom] += times * coefficient) == 0) form.erase(atom);
}

Form combined(const Form& a, const Form& b, Wide times) {
  Form form = a;
  add_to(form, b, times);
  return form;
}

Form times(const Form& a, Wide factor) { return combined({}, a, factor); }

Wide sign_of(const Form& form) { return !form.empty() && form.begin()->second < 0 ? -1 : 1; }

bool is_number(const Form& form) { return form.empty() || (form.size() == 1 && form.begin()->first == kOne); }

Wide number_in(const Form& form) { return form.empty() ? 0 : form.begin()->second; }

Source swapped(Source source) {
  switch (source) {
    case Source::own_v:
      return Source::other_v;
    case Source::other_v:
      return Source::own_v;
    case Source::own_constant:
      return Source::other_constant;
    case Source::other_constant:
      return Source::own_constant;
    case Source::own_field:
      return Source::other_field;
    case Source::other_field:
      return Source::own_field;
    case Source::own_id:
      return Source::other_id;
    case Source::other_id:
      return Source::own_id;
    default:
      return source;
  }
}

class Numbering {
 public:
  std::vector<Form> forms_of(const Graph& graph, bool swap) {
    std::vector<Form> forms;
    for (const Node& node : graph.nodes) {
      std::vector<Form> in;
      for (const int k : node.inputs) in.push_back(forms[static_cast<size_t>(k)]);
      forms.push_back(node.op == Op::input ? input(node, swap) : value(node, in));
    }
    return forms;
  }

 private:
  Form atom(const Node& node, std::initializer_list<Wide> parameters, const std::vector<Form>& in,
            Wide coefficient = 1) {
    Key key{static_cast<Wide>(node.op)};
    key.insert(key.end(), parameters);
    for (const Form& form : in) {
      key.push_back(static_cast<Wide>(form.size()));
      for (const auto& [atom, c] : form) key.push_back(atom), key.push_back(c);
    }
    const int next = static_cast<int>(atoms_.size()) + 1;
    return {{atoms_.try_emplace(key, next).first->second, coefficient}};
  }

  Form input(const Node& node, bool swap) {
    const Source source = swap ? swapped(node.source) : node.source;
    const bool constant = node.source == Source::pair_constant || node.source == Source::bond_constant;
    const bool turned = swap && constant && !node.symmetric && !node.opposite;
    const bool odd = swap && (node.source == Source::apart || node.opposite);
    return atom(node, {static_cast<Wide>(source), node.index, node.axis, turned}, {}, odd ? -1 : 1);
  }

  // An operation that is odd in `in[0]`, and does not depend on its sign otherwise.
  Form odd(const Node& node, std::initializer_list<Wide> parameters, std::vector<Form> in) {
    if (in[0].empty()) return {};
    const Wide sign = sign_of(in[0]);
    in[0] = times(in[0], sign);
    return atom(node, parameters, in, sign);
  }

  Form unordered(const Node& node, std::initializer_list<Wide> parameters, std::vector<Form> in) {
    if (in[1] < in[0]) std::swap(in[0], in[1]);
    return atom(node, parameters, in);
  }

  Form product(Form a, Form b) {
    if (is_number(a)) return times(b, number_in(a));
    if (is_number(b)) return times(a, number_in(b));
    const Wide sign = sign_of(a) * sign_of(b);
    return times(unordered({.op = Op::mul}, {}, {times(a, sign_of(a)), times(b, sign_of(b))}), sign);
  }

  Form rounded(const Form& a, int shift) { return shift == 0 ? a : odd({.op = Op::round}, {shift}, {a}); }

  Form less(const Form& a, const Form& b) { return atom({.op = Op::lt}, {}, {combined(a, b, -1)}); }

  // min(-a, -b) = -max(a, b)
  Form extreme(const Node& node, Form a, Form b) {
    Wide sign_a = sign_of(a), sign_b = sign_of(b);
    const auto place = [](const Form& form, Wide sign) { return std::pair(times(form, sign), -sign); };
    if (place(b, sign_b) < place(a, sign_a)) std::swap(a, b), std::swap(sign_a, sign_b);
    const bool least = (node.op == Op::min) == (sign_a > 0);
    return times(unordered({.op = least ? Op::min : Op::max}, {}, {times(a, sign_a), times(b, sign_a)}),
                 sign_a);
  }

  Form chosen(const Node& node, const std::vector<Form>& in) {
    const Wide sign = in[1].empty() ? sign_of(in[2]) : sign_of(in[1]);
    return atom(node, {}, {in[0], times(in[1], sign), times(in[2], sign)}, sign);
  }

  Form value(const Node& node, const std::vector<Form>& in) {
    switch (node.op) {
      case Op::constant:
        return node.number == 0 ? Form{} : Form{{kOne, node.number}};
      case Op::add:
        return combined(in[0], in[1], 1);
      case Op::sub:
        return combined(in[0], in[1], -1);
      case Op::neg:
        return times(in[0], -1);
      case Op::shl:
        return times(in[0], Wide{1} << node.shift);
      case Op::round:
        return rounded(in[0], node.shift);
      case Op::mul:
        return rounded(product(in[0], in[1]), node.shift);
      case Op::mac:
        return combined(in[0], rounded(product(in[1], in[2]), node.shift), 1);
      case Op::dot:
        return dot(node, in);
      case Op::lt:
        return less(in[0], in[1]);
      case Op::le:
        return combined({{kOne, 1}}, less(in[1], in[0]), -1);
      case Op::negate:
        return combined({{kOne, 1}}, in[0], -1);
      case Op::within:
        return in[0];
      default:
        return other_value(node, in);
    }
  }

  Form dot(const Node& node, const std::vector<Form>& in) {
    Form sum;
    const size_t n = in.size() / 2;
    for (size_t k = 0; k < n; ++k) add_to(sum, product(in[k], in[n + k]), 1);
    return rounded(sum, node.shift);
  }

  Form other_value(const Node& node, const std::vector<Form>& in) {
    const Interval range = node.range;
    const Form difference = node.op == Op::eq ? combined(in[0], in[1], -1) : Form{};
    switch (node.op) {
      case Op::eq:
        return atom(node, {}, {times(difference, sign_of(difference))});
      case Op::both:
      case Op::either:
        return unordered(node, {}, in);
      case Op::select:
        return chosen(node, in);
      case Op::min:
      case Op::max:
        return extreme(node, in[0], in[1]);
      case Op::abs:
        return atom(node, {}, {times(in[0], sign_of(in[0]))});
      case Op::clamp:
        return range.low == -range.high ? odd(node, {range.low, range.high}, in)
                                        : atom(node, {range.low, range.high}, in);
      case Op::shift:
        return odd(node, {}, in);
      case Op::check:
        return in[1] == Form{{kOne, 1}} ? in[0] : atom(node, {node.width}, in);
      case Op::noise:
        return unordered(node, {node.number, node.width}, in);
      default:
        return atom(node, {node.shift, node.width, node.table}, in);  // floor, lookup, msb, align
    }
  }

  std::map<Key, int> atoms_;
};

}  // namespace

std::vector<Parity> parities_of(const Graph& pair) {
  Numbering numbering;
  const std::vector<Form> as_is = numbering.forms_of(pair, false), swapped = numbering.forms_of(pair, true);
  std::vector<Parity> parities;
  for (size_t n = 0; n < as_is.size(); ++n)
    parities.push_back(as_is[n].empty()                    ? Parity::zero
                       : swapped[n] == as_is[n]            ? Parity::even
                       : swapped[n] == times(as_is[n], -1) ? Parity::odd
                                                           : Parity::none);
  return parities;
}

const char* to_string(Parity parity) {
  constexpr const char* kNames[] = {"none", "even", "odd", "zero"};
  return kNames[static_cast<size_t>(parity)];
}

}  // namespace cuboct::graph
