// Files and an exit code for an image under an emulator or a debugger (Arm semihosting specification). For test images
// only: on a bare processor the breakpoint instruction is a fault.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace breakaway::emulated {

inline std::int32_t semihosting_call(std::uint32_t operation, const void* arguments) noexcept {
  register std::uint32_t r0 asm("r0") = operation;
  register const void* r1 asm("r1") = arguments;
#if __ARM_ARCH_PROFILE == 'M'
  asm volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
#else
  asm volatile("svc 0x123456" : "+r"(r0) : "r"(r1) : "memory", "lr");
#endif
  return static_cast<std::int32_t>(r0);
}

enum class OpenMode : std::uint32_t { read_binary = 1, write_binary = 5 };

class HostFile {
 public:
  HostFile(std::string_view name, OpenMode mode) noexcept {
    const std::uint32_t arguments[] = {address(name.data()), static_cast<std::uint32_t>(mode),
                                       static_cast<std::uint32_t>(name.size())};
    handle_ = semihosting_call(0x01, arguments);
  }
  HostFile(const HostFile&) = delete;
  HostFile& operator=(const HostFile&) = delete;
  ~HostFile() {
    const std::uint32_t arguments[] = {static_cast<std::uint32_t>(handle_)};
    semihosting_call(0x02, arguments);
  }

  bool is_open() const noexcept { return handle_ >= 0; }
  // Bytes read; 0 at the end of the file.
  std::size_t read(void* bytes, std::size_t count) noexcept { return count - left_by(0x06, bytes, count); }
  bool write(const void* bytes, std::size_t count) noexcept { return left_by(0x05, bytes, count) == 0; }

 private:
  static std::uint32_t address(const void* pointer) noexcept { return reinterpret_cast<std::uint32_t>(pointer); }
  std::size_t left_by(std::uint32_t operation, const void* bytes, std::size_t count) noexcept {
    const std::uint32_t arguments[] = {static_cast<std::uint32_t>(handle_), address(bytes), count};
    return static_cast<std::size_t>(semihosting_call(operation, arguments));
  }
  std::int32_t handle_ = -1;
};

[[noreturn]] inline void exit_emulator(std::uint32_t code) noexcept {
  constexpr std::uint32_t application_exit = 0x20026;
  const std::uint32_t arguments[] = {application_exit, code};
  semihosting_call(0x20, arguments);
  for (;;) {
  }
}

}  // namespace breakaway::emulated
