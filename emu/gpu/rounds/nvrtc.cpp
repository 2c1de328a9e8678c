// SPDX-License-Identifier: MIT
#include "emu/gpu/rounds/nvrtc.h"

#include <fmt/format.h>

#include <filesystem>
#include <iterator>
#include <memory>

#include "emu/gpu/rounds/rounds_text.h"
#include "model/base/error.h"
#include "model/base/host_compiler.h"
#include "model/base/output.h"

namespace cuboct::gpu {
namespace {

namespace fs = std::filesystem;

constexpr const char* kOptions[] = {"--std=c++20"};

// NVRTC has no library: what the headers need of one.
constexpr const char* kIntegers =
    "using int8_t = signed char; using uint8_t = unsigned char;\n"
    "using int16_t = short; using uint16_t = unsigned short;\n"
    "using int32_t = int; using uint32_t = unsigned int;\n"
    "using int64_t = long; using uint64_t = unsigned long;\n";

std::string first_error(const std::string& log) {
  const size_t at = log.find("error");
  if (at == std::string::npos) return log.substr(0, log.find('\n'));
  const size_t begin = log.rfind('\n', at) + 1;  // npos + 1: the log's begin
  return log.substr(begin, log.find('\n', at) - begin);
}

}  // namespace

Nvrtc::Nvrtc(const std::vector<std::string>& libraries) : library_("CUDA's compiler", libraries) {
  library_.bind(call_.version, "nvrtcVersion");
  library_.bind(call_.error, "nvrtcGetErrorString");
  library_.bind(call_.create, "nvrtcCreateProgram");
  library_.bind(call_.destroy, "nvrtcDestroyProgram");
  library_.bind(call_.compile, "nvrtcCompileProgram");
  library_.bind(call_.log_size, "nvrtcGetProgramLogSize");
  library_.bind(call_.log, "nvrtcGetProgramLog");
  library_.bind(call_.code_size, "nvrtcGetCUBINSize");
  library_.bind(call_.code, "nvrtcGetCUBIN");
}

void Nvrtc::check(int answer, const char* what) const {
  if (answer != 0) throw NvrtcError(fmt::format("CUDA's compiler {}: {}", what, call_.error(answer)));
}

std::string Nvrtc::version() const {
  int major = 0, minor = 0;
  check(call_.version(&major, &minor), "tells no version");
  return fmt::format("{}.{}", major, minor);
}

std::string Nvrtc::compiled(const std::string& source,
                            const std::vector<std::pair<std::string, std::string>>& headers,
                            const std::string& architecture) const {
  std::vector<const char*> names{"cstddef", "cstdint"}, texts{"", kIntegers};
  for (const auto& [name, text] : headers) names.push_back(name.c_str()), texts.push_back(text.c_str());
  Program program = nullptr;
  check(call_.create(&program, source.c_str(), "rounds.cu", static_cast<int>(names.size()), texts.data(),
                     names.data()),
        "takes no source");
  const auto goes = [&](Program* p) { call_.destroy(p); };
  const std::unique_ptr<Program, decltype(goes)> owner(&program, goes);
  const std::string target = "--gpu-architecture=" + architecture;
  std::vector<const char*> options{target.c_str()};
  options.insert(options.end(), std::begin(kOptions), std::end(kOptions));
  const int answer = call_.compile(program, static_cast<int>(options.size()), options.data());
  if (answer != 0) {
    size_t size = 0;
    std::string log;
    if (call_.log_size(program, &size) == 0 && size > 1) {
      log.resize(size);
      call_.log(program, log.data());
      log.resize(size - 1);
    }
    throw NvrtcError(
        fmt::format("CUDA's compiler {}: {}: {}", version(), call_.error(answer), first_error(log)));
  }
  size_t size = 0;
  check(call_.code_size(program, &size), "has no code");
  std::string code(size, '\0');
  check(call_.code(program, code.data()), "has no code");
  return code;
}

std::string compiled_file(const std::string& source, const std::string& architecture,
                          const std::string& directory) {
  if (!architecture.starts_with("sm_"))
    throw NvrtcError(fmt::format("CUDA's compiler knows no architecture '{}'", architecture));
  if (directory.empty())
    throw NvrtcError("neither XDG_CACHE_HOME nor HOME is set: no place to keep compiled rules");
  const Nvrtc nvrtc;
  std::vector<std::string> parts{source, nvrtc.version(), architecture, kIntegers};
  parts.insert(parts.end(), std::begin(kOptions), std::end(kOptions));
  for (const auto& [name, text] : round_headers()) parts.insert(parts.end(), {name, text});
  const std::string path =
      (fs::path(directory) / fmt::format("rule-{}-{:016x}.cubin", architecture, key_of_texts(parts)))
          .string();
  if (fs::exists(path)) return path;
  const std::string code = nvrtc.compiled(source, round_headers(), architecture);
  try {
    make_directory(directory);
    write_text(path, code);
  } catch (const InputError& e) {
    throw NvrtcError(e.what());
  }
  return path;
}

}  // namespace cuboct::gpu
