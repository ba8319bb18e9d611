#include "glcompute/program.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cstring>
#include <vector>

#include "glcompute/compile_log.h"
#include "plan/kernel_lines.h"

namespace pcphys {
namespace {

Error refused(const std::string& label, const std::string& log, const ProgramSource& source) {
  std::string message = "The GL driver refused the program `" + label + "`: " + with_quotes(log, source) + " (files:";
  for (std::size_t i = 0; i < source.files.size(); i++) message += ' ' + std::to_string(i) + ' ' + source.files[i];
  return {ErrorCode::device_error, message + ")."};
}

template <class GetLength, class GetLog> std::string log_of(GLuint object, GetLength get_length, GetLog get_log) {
  GLint bytes = 0;
  get_length(object, GL_INFO_LOG_LENGTH, &bytes);
  std::string text(std::size_t(bytes < 1 ? 1 : bytes), '\0');
  get_log(object, GLsizei(text.size()), nullptr, text.data());
  while (!text.empty() && (text.back() == '\0' || text.back() == '\n')) text.pop_back();
  return text;
}

bool linked(GLuint program) {
  GLint ok = GL_FALSE;
  glGetProgramiv(program, GL_LINK_STATUS, &ok);
  return ok == GL_TRUE;
}

bool binaries_supported() {
  GLint formats = 0;
  glGetIntegerv(GL_NUM_PROGRAM_BINARY_FORMATS, &formats);
  return formats > 0;
}

/// 0 when the cache has nothing that this driver takes.
GLuint from_cache(const ProgramSource& source, const ProgramCache& cache) {
  if (!binaries_supported()) return 0;
  const std::optional<std::vector<char>> bytes = cache.load(source.text);
  GLenum format = 0;
  if (!bytes || bytes->size() <= sizeof format) return 0;
  std::memcpy(&format, bytes->data(), sizeof format);
  const GLuint program = glCreateProgram();
  glProgramBinary(program, format, bytes->data() + sizeof format, GLsizei(bytes->size() - sizeof format));
  if (linked(program)) return program;
  glDeleteProgram(program);
  while (glGetError() != GL_NO_ERROR) {}  // a refused binary is no error
  return 0;
}

void to_cache(GLuint program, const ProgramSource& source, const ProgramCache& cache) {
  GLint size = 0;
  glGetProgramiv(program, GL_PROGRAM_BINARY_LENGTH, &size);
  if (!binaries_supported() || size <= 0) return;
  GLenum format = 0;
  std::vector<char> bytes(sizeof format + std::size_t(size));
  glGetProgramBinary(program, size, nullptr, &format, bytes.data() + sizeof format);
  std::memcpy(bytes.data(), &format, sizeof format);
  if (glGetError() == GL_NO_ERROR) cache.store(source.text, bytes);
}

Result<GLuint> compile(const ProgramSource& source, const std::string& label) {
  const GLuint shader = glCreateShader(GL_COMPUTE_SHADER);
  const char* text = source.text.c_str();
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint ok = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
  if (!ok) {
    const std::string log = log_of(shader, glGetShaderiv, glGetShaderInfoLog);
    glDeleteShader(shader);
    return refused(label, log, source);
  }
  const GLuint program = glCreateProgram();
  glProgramParameteri(program, GL_PROGRAM_BINARY_RETRIEVABLE_HINT, GL_TRUE);
  glAttachShader(program, shader);
  glLinkProgram(program);
  glDetachShader(program, shader);
  glDeleteShader(shader);
  if (linked(program)) return program;
  const std::string log = log_of(program, glGetProgramiv, glGetProgramInfoLog);
  glDeleteProgram(program);
  return refused(label, log, source);
}

// ---- introspection ----------------------------------------------------------------------------------
GLint property_of(GLuint program, GLenum interface, GLuint index, GLenum property) {
  GLint value = -1;
  glGetProgramResourceiv(program, interface, index, 1, &property, 1, nullptr, &value);
  return value;
}

Status expect(std::string_view buffer, const char* what, std::int64_t expected, std::int64_t found) {
  if (expected == found) return {};
  return Error{ErrorCode::device_error, "The GL program sees `" + std::string(buffer) + "` with " + what + " " +
                                            std::to_string(found) + " where pcphys has " + std::to_string(expected) +
                                            "; the driver or the precision does not fit."};
}

/// GL reports either stride for an array of vectors, 0 for the one that does not apply.
GLint stride_of(GLuint program, GLuint variable) {
  const GLint stride = property_of(program, GL_BUFFER_VARIABLE, variable, GL_ARRAY_STRIDE);
  return stride > 0 ? stride : property_of(program, GL_BUFFER_VARIABLE, variable, GL_TOP_LEVEL_ARRAY_STRIDE);
}

Status check_buffer(GLuint program, Buffer buffer, std::uint32_t binding, Precision precision) {
  const BufferSchema& what = schema(buffer);
  const std::string variable = "io_" + std::string(what.name) + "[0]";
  const GLuint index = glGetProgramResourceIndex(program, GL_BUFFER_VARIABLE, variable.c_str());
  if (index == GL_INVALID_INDEX) return {};  // declared by the kernel's accesses but not used by its text
  const bool f64 = precision == Precision::f64, scalars = scalar_elements(buffer, precision);
  const GLint vectors = f64 ? GL_DOUBLE_VEC4 : GL_FLOAT_VEC4;
  const GLint type = what.reals == 0 ? GL_UNSIGNED_INT : scalars ? GL_DOUBLE : vectors;
  const GLint stride = what.reals == 0 ? 4 : scalars ? 8 : f64 ? 32 : 16;
  const GLuint block = GLuint(property_of(program, GL_BUFFER_VARIABLE, index, GL_BLOCK_INDEX));
  Status status = expect(what.name, "element type", type, property_of(program, GL_BUFFER_VARIABLE, index, GL_TYPE));
  if (status) status = expect(what.name, "stride", stride, stride_of(program, index));
  if (status) status = expect(what.name, "offset", 0, property_of(program, GL_BUFFER_VARIABLE, index, GL_OFFSET));
  if (status)
    status =
        expect(what.name, "binding", binding, property_of(program, GL_SHADER_STORAGE_BLOCK, block, GL_BUFFER_BINDING));
  return status;
}

Status check_info_field(GLuint program, const char* field, std::size_t position, Precision precision) {
  const std::string variable = std::string("PcInfo.") + field;
  const GLuint index = glGetProgramResourceIndex(program, GL_UNIFORM, variable.c_str());
  if (index == GL_INVALID_INDEX) return {};
  const std::size_t bytes = precision == Precision::f64 ? sizeof(std::uint64_t) : sizeof(std::uint32_t);
  return expect(variable, "offset", std::int64_t(position * bytes), property_of(program, GL_UNIFORM, index, GL_OFFSET));
}

}  // namespace

Result<std::uint32_t> link_program(const ProgramSource& source, const std::string& label, const ProgramCache& cache) {
  if (const GLuint program = from_cache(source, cache)) return program;
  Result<GLuint> program = compile(source, label);
  if (program) to_cache(*program, source, cache);
  return program;
}

Status check_layout(std::uint32_t program, Kernel kernel, Precision precision) {
  std::uint32_t binding = 0;
  for (const Access& access : schema(kernel).accesses)
    if (Status status = check_buffer(program, access.buffer, binding++, precision); !status) return status;
  std::size_t position = 0;
#define PC_INFO_FIELD(name, doc) \
  if (Status status = check_info_field(program, #name, position++, precision); !status) return status;
#include "kernels/info.inl"
#undef PC_INFO_FIELD
  return {};
}

Result<KernelProgram> load_kernel(Kernel kernel, const SourceOptions& options, const ProgramCache& cache) {
  const std::string label(schema(kernel).name);
  const Result<ProgramSource> source = kernel_source(kernel, options);
  if (!source) return source.error();
  const Result<std::uint32_t> program = link_program(*source, label, cache);
  if (!program) return program.error();
  if (Status status = check_layout(*program, kernel, options.precision); !status) {
    glDeleteProgram(*program);
    return status.error();
  }
  // none where nothing is shared
  glProgramUniform1i(*program, glGetUniformLocation(*program, "pc_scattered"), options.scattered);
  return KernelProgram{*program, glGetUniformLocation(*program, "pc_range")};
}

namespace {

/// What is said of a joined text is asked for once more, of the text with the lines of its file.
Result<std::uint32_t> link_own(const OwnKernel& kernel, const SourceOptions& options, const ProgramCache& cache) {
  const Result<ProgramSource> source = own_kernel_source(kernel, options);
  Result<std::uint32_t> program =
      source ? link_program(*source, kernel.name, cache) : Result<std::uint32_t>(source.error());
  if (program || kernel.own_lines) return program;
  const std::optional<KernelLines> lines = read_lines(kernel);
  if (!lines)
    return Error{program.error().code, program.error().message + " The text was not found in " + kernel.file +
                                           ", so that its lines are not known: its statements are quoted."};
  OwnKernel laid_out = kernel;
  laid_out.body = lines->body.text;
  laid_out.line = lines->body.line;
  laid_out.own_lines = true;
  return link_own(laid_out, options, cache);
}

}  // namespace

Result<OwnProgram> load_kernel(const OwnKernel& kernel, const SourceOptions& options, const ProgramCache& cache) {
  const Result<std::uint32_t> program = link_own(kernel, options, cache);
  if (!program) return program.error();
  const auto location = [](GLuint id, const std::string& name) { return glGetUniformLocation(id, name.c_str()); };
  OwnProgram own{*program,
                 location(*program, "pc_range"),
                 location(*program, "pc_work"),
                 location(*program, "pc_cutoff_squared"),
                 {},
                 {}};
  for (const OwnArgument& a : kernel.arguments)
    for (std::uint32_t c = 0; c < components(a.type); c++)
      own.parameters.push_back(a.of_property() || a.given ? -1
                                                          : location(own.id, "pc_" + a.name + "_" + std::to_string(c)));
  if (kernel.form == OwnKernel::Form::element) return own;
  const Result<ProgramSource> totals = own_totals_source(kernel, options);
  const Result<std::uint32_t> second =
      totals ? link_program(*totals, kernel.name, cache) : Result<std::uint32_t>(totals.error());
  if (!second) {
    glDeleteProgram(own.id);
    return second.error();
  }
  own.totals = {*second, location(*second, "pc_range"), location(*second, "pc_work")};
  return own;
}

void dispatch(std::int32_t range_location, std::uint32_t begin, std::uint32_t end, const GlLimits& limits,
              std::uint32_t rows, std::uint32_t each) {
  const std::uint64_t piece = std::uint64_t(limits.work_group_count) * each;
  for (std::uint64_t k = begin; k < end; k += piece) {
    const std::uint32_t stop = std::uint32_t(std::min<std::uint64_t>(end, k + piece));
    glUniform2ui(range_location, std::uint32_t(k), stop);
    glDispatchCompute((stop - std::uint32_t(k) + each - 1) / each, rows, 1);
  }
}

}  // namespace pcphys
