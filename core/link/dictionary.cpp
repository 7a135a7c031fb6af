#include "link/dictionary.hpp"

#include <stdexcept>
#include <utility>

namespace passo::wire {

Format::Format(int32_t id_, const std::string& text_) : id(id_), text(text_) {
  size_t at = text.find(' ');
  name = text.substr(0, at);
  if (name.empty()) throw std::invalid_argument("empty message format");
  while (at != std::string::npos) {
    size_t begin = at + 1;
    at = text.find(' ', begin);
    std::string word = text.substr(begin, at == std::string::npos ? at : at - begin);
    size_t equals = word.find('=');
    if (equals == std::string::npos || equals == 0)
      throw std::invalid_argument("bad parameter '" + word + "' in '" + text + "'");
    parameters.push_back({word.substr(0, equals), type_of(word.substr(equals + 1))});
  }
}

void Format::encode(const std::vector<Value>& values, Bytes& out) const {
  if (values.size() != parameters.size())
    throw std::invalid_argument(name + ": expected " + std::to_string(parameters.size()) +
                                " values");
  put(out, uint32_t(id));
  for (size_t i = 0; i < values.size(); ++i) {
    const auto* number = std::get_if<int64_t>(&values[i]);
    if ((parameters[i].type == Type::blob) != !number)
      throw std::invalid_argument(name + ": wrong type of " + parameters[i].name);
    if (number) {
      put(out, uint32_t(*number));
      continue;
    }
    const auto& blob = std::get<std::string>(values[i]);
    if (blob.size() > kPayloadMax) throw std::invalid_argument(name + ": too long");
    out.push_back(uint8_t(blob.size()));
    out.insert(out.end(), blob.begin(), blob.end());
  }
}

void Format::decode(Reader& in, std::vector<Value>& values) const {
  values.clear();
  for (const Parameter& p : parameters) {
    if (p.type == Type::blob) {
      size_t size;
      const uint8_t* at = in.blob(size);
      values.emplace_back(std::string(at, at + size));
    } else {
      uint32_t v = in.vlq();
      values.emplace_back(is_signed(p.type) ? int64_t(int32_t(v)) : int64_t(v));
    }
  }
}

Type Format::type_of(const std::string& conversion) {
  if (conversion == "%s" || conversion == "%.*s" || conversion == "%*s") return Type::blob;
  if (conversion == "%c") return Type::byte;
  if (conversion == "%hu") return Type::unsigned_word;
  if (conversion == "%hi") return Type::signed_word;
  if (conversion == "%u") return Type::unsigned_int;
  if (conversion == "%i") return Type::signed_int;
  throw std::invalid_argument("unknown conversion '" + conversion + "'");
}

void Format::put(Bytes& out, uint32_t value) {
  uint8_t buffer[kVlqMax];
  out.insert(out.end(), buffer, put_vlq(buffer, value));
}

void Formats::add(int32_t id, const std::string& text) {
  Format format(id, text);
  if (id < -32 || id > 16383) throw std::invalid_argument("message id out of range: " + text);
  if (by_id_.count(id)) throw std::invalid_argument("message id used twice: " + text);
  by_id_[id] = list_.size();
  by_name_[format.name] = list_.size();
  list_.push_back(std::move(format));
}

const Format* Formats::find(int32_t id) const {
  auto it = by_id_.find(id);
  return it == by_id_.end() ? nullptr : &list_[it->second];
}

const Format* Formats::find(const std::string& name) const {
  auto it = by_name_.find(name);
  return it == by_name_.end() ? nullptr : &list_[it->second];
}

const Format& Formats::at(const std::string& name) const {
  const Format* format = find(name);
  if (!format) throw std::invalid_argument("the board has no message '" + name + "'");
  return *format;
}

}  // namespace passo::wire
