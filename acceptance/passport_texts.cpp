#include "acceptance/passport_texts.hpp"

#include <algorithm>
#include <array>

namespace fogbench::acceptance {
namespace {

struct Phrase {
  std::string_view english, russian;

  constexpr bool complete() const { return !english.empty() && !russian.empty(); }
  constexpr std::string_view in(Language language) const {
    return language == Language::kRussian ? russian : english;
  }
};

struct Entry {
  Text which;
  Phrase phrase;
};

struct Named {
  std::string_view id;
  Phrase phrase;
};

constexpr Entry kTexts[] = {
    {Text::kTitle, {"Passport of the fiber-optic gyro", "Паспорт волоконно-оптического гироскопа"}},
    {Text::kLanguageCode, {"en", "ru"}},
    {Text::kDecimalMark, {".", ","}},
    {Text::kIssued, {"issued", "составлен"}},
    {Text::kGyro, {"Gyro, serial number", "Гироскоп, заводской номер"}},
    {Text::kOverallPass,
     {"Pass: every limited quantity is within its limits",
      "Годен: все нормируемые величины в пределах норм"}},
    {Text::kOverallFail,
     {"Fail: a limited quantity is outside its limits",
      "Не годен: есть величина за пределами норм"}},
    {Text::kOverallIndeterminate,
     {"Indeterminate: these measurements neither prove nor exclude that the limits are kept",
      "Заключение невозможно: измерения не доказывают и не исключают соответствия нормам"}},
    {Text::kPass, {"pass", "соответствует"}},
    {Text::kFail, {"fail", "не соответствует"}},
    {Text::kIndeterminate, {"indeterminate", "не определено"}},
    {Text::kNotJudged, {"not limited", "не нормируется"}},
    {Text::kRemarks, {"Remarks", "Замечания"}},
    {Text::kLimits, {"Limits and verdict", "Нормы и заключение"}},
    {Text::kRule,
     {"U is the expanded uncertainty with coverage factor k = {}. Pass: the value with U to either "
      "side is within the limits. Fail: all of it is outside. Otherwise indeterminate (JCGM 106).",
      "U — расширенная неопределённость, коэффициент охвата k = {}. Соответствует: значение вместе "
      "с "
      "U в обе стороны лежит в пределах норм. Не соответствует: целиком вне их. Иначе не "
      "определено "
      "(JCGM 106, ГОСТ Р 52691)."}},
    {Text::kQuantity, {"quantity", "величина"}},
    {Text::kUnit, {"unit", "единица"}},
    {Text::kTest, {"test", "испытание"}},
    {Text::kValue, {"value", "значение"}},
    {Text::kUncertainty, {"U", "U"}},
    {Text::kConditions, {"measured at", "условия"}},
    {Text::kMicrotesla, {"µT", "мкТл"}},
    {Text::kRemarkNoQuantity,
     {"Limits: no result is called {}; the nearest is {}.",
      "Нормы: нет величины {}; ближайшая {}."}},
    {Text::kMinimum, {"minimum", "мин."}},
    {Text::kMaximum, {"maximum", "макс."}},
    {Text::kVerdict, {"verdict", "заключение"}},
    {Text::kMissing, {"missing", "нет данных"}},
    {Text::kTooFewTests, {"measured in {} of {} tests", "измерено в {} из {} испытаний"}},
    {Text::kRepeatability, {"Repeatability", "Повторяемость"}},
    {Text::kDifference, {"difference", "разность"}},
    {Text::kLimit, {"limit", "норма"}},
    {Text::kWithinNoise, {"within U", "в пределах U"}},
    {Text::kBeyondNoise, {"beyond U", "больше U"}},
    {Text::kChange,
     {"Magnetic coefficients from test {} to test {}: common scale {} ± {}, direction turned by "
      "{}°; probability of such a difference by chance: {}.",
      "Магнитные коэффициенты, от испытания {} к испытанию {}: общий множитель {} ± {}, поворот "
      "направления на {}°; вероятность такого случайного расхождения: {}."}},
    {Text::kCoefficients, {"Coefficients of the error model", "Коэффициенты модели погрешности"}},
    {Text::kModel, {"model", "модель"}},
    {Text::kNotDetermined, {"not determined", "не определяется"}},
    {Text::kPointsOfFit, {"points", "точек"}},
    {Text::kUncertaintyScope,
     {"Temperature terms count from {} °C. Uncertainties are of the gyro's noise and the fit; "
      "those "
      "of the instruments' calibrations are in their certificates.",
      "Температурные члены отсчитываются от {} °C. Неопределённости учитывают шум гироскопа и "
      "подгонку; неопределённости поверки приборов — в их свидетельствах."}},
    {Text::kThermal,
     {"Deviation from the baseline by temperature",
      "Отклонение от исходного значения по температуре"}},
    {Text::kSetPoint, {"set point, °C", "уставка, °C"}},
    {Text::kTemperature, {"temperature, °C", "температура, °C"}},
    {Text::kAverages, {"averages", "средних"}},
    {Text::kDeviation, {"deviation ± U, °/h", "отклонение ± U, °/ч"}},
    {Text::kSigma, {"σ, °/h", "σ, °/ч"}},
    {Text::kMagnetic, {"Sweeps of the magnetic field", "Циклы магнитного поля"}},
    {Text::kAxis, {"axis", "ось"}},
    {Text::kK, {"K ± U, °/h per 100 µT", "K ± U, °/ч на 100 мкТл"}},
    {Text::kClosure, {"closure ± U, °/h", "замыкание ± U, °/ч"}},
    {Text::kClosureScope,
     {"K is from the extreme set levels. The closure of the zero-field readings (first − 2 middle "
      "+ "
      "last) is 0 for a linear drift, −3r for a remanence of ±r; its U is that of white noise, a "
      "lower bound.",
      "K — по крайним заданным уровням. Замыкание показаний в нулевом поле (первое − 2 средних + "
      "последнее) равно 0 при линейном уходе и −3r при остаточном намагничении ±r; его U — от "
      "белого "
      "шума, оценка снизу."}},
    {Text::kNoise, {"Noise terms (IEEE 952)", "Составляющие шума (IEEE 952)"}},
    {Text::kNoiseTerm, {"term", "составляющая"}},
    {Text::kNoiseRecord,
     {"From the Allan deviation of {} averages over {} s, test {}, segment {}.",
      "По отклонению Аллана {} средних за {} с, испытание {}, участок {}."}},
    {Text::kNoNoiseRecord,
     {"No stretch at rest is long enough for an Allan deviation.",
      "Нет участка покоя, достаточного для отклонения Аллана."}},
    {Text::kNotSeen, {"not seen in this record", "не обнаруживается"}},
    {Text::kQuantisation, {"quantisation Q", "квантование Q"}},
    {Text::kPlots, {"Measurements", "Измерения"}},
    {Text::kByTemperature, {"Deviation by temperature", "Отклонение от температуры"}},
    {Text::kByField, {"Deviation by the field along {}", "Отклонение от поля вдоль {}"}},
    {Text::kDeviationAxis, {"deviation, °/h", "отклонение, °/ч"}},
    {Text::kTemperatureAxis, {"temperature, °C", "температура, °C"}},
    {Text::kFieldAxis, {"measured field, µT", "измеренное поле, мкТл"}},
    {Text::kMarksOfTest,
     {"test {}; line: the fitted coefficients", "испытание {}; линия: найденные коэффициенты"}},
    {Text::kProvenance, {"Origin of the data", "Происхождение данных"}},
    {Text::kRun, {"run", "прогон"}},
    {Text::kProcedure, {"procedure", "методика"}},
    {Text::kOperator, {"operator", "оператор"}},
    {Text::kBench, {"bench", "стенд"}},
    {Text::kSeed, {"seed of the simulation", "зерно имитации"}},
    {Text::kStarted, {"started", "начат"}},
    {Text::kEnded, {"ended", "окончен"}},
    {Text::kOutcome, {"outcome", "исход"}},
    {Text::kSoftware, {"software", "программа"}},
    {Text::kConfiguration, {"configuration, SHA-256", "конфигурация, SHA-256"}},
    {Text::kRawData, {"raw data, SHA-256", "исходные данные, SHA-256"}},
    {Text::kPoints, {"points", "точек"}},
    {Text::kPointsVoid, {"of them void", "из них недействительных"}},
    {Text::kFrames, {"frames", "кадров"}},
    {Text::kFramesMissing, {"missing", "потеряно"}},
    {Text::kIntact, {"checked, unchanged", "проверены, не изменены"}},
    {Text::kChanged, {"NOT as they were written", "НЕ совпадают с записанными"}},
    {Text::kNotRecorded, {"not recorded", "не записан"}},
    {Text::kCompleted, {"completed", "завершён"}},
    {Text::kAborted, {"aborted", "прерван оператором"}},
    {Text::kFailed, {"failed", "прерван отказом"}},
    {Text::kInterrupted, {"interrupted", "оборвался"}},
    {Text::kUnderWay, {"under way", "продолжается"}},
    {Text::kTakenUp, {"the next run goes on from there", "продолжен следующим прогоном"}},
    {Text::kInstruments, {"Instruments", "Средства измерений"}},
    {Text::kInstrument, {"instrument", "прибор"}},
    {Text::kIdentity, {"identity", "тип"}},
    {Text::kSerialNumber, {"serial number", "заводской номер"}},
    {Text::kCalibrated, {"calibrated", "поверен"}},
    {Text::kDue, {"due", "поверка до"}},
    {Text::kSignatures, {"Signatures", "Подписи"}},
    {Text::kTestedBy, {"Tested by", "Испытания провёл"}},
    {Text::kCheckedBy, {"Quality control", "Представитель ОТК"}},
    {Text::kCustomer, {"Customer's representative", "Представитель заказчика"}},
    {Text::kName, {"name", "фамилия, инициалы"}},
    {Text::kSignature, {"signature", "подпись"}},
    {Text::kDate, {"date", "дата"}},
    {Text::kRemarkSimulated,
     {"Run {} is of a simulated bench: it says nothing about a real gyro.",
      "Прогон {} выполнен на имитаторе стенда и ничего не говорит о настоящем гироскопе."}},
    {Text::kRemarkUnfinished,
     {"Run {} was not completed ({}): the verdict is no better than indeterminate.",
      "Прогон {} не завершён ({}): положительное заключение невозможно."}},
    {Text::kRemarkRawData,
     {"Run {}: the raw data are not as they were written: the verdict is no better than "
      "indeterminate.",
      "Прогон {}: исходные данные не совпадают с записанными: положительное заключение "
      "невозможно."}},
    {Text::kRemarkOverdue,
     {"Run {}: overdue for calibration: {}.", "Прогон {}: просрочена поверка: {}."}},
    {Text::kRemarkNoCalibration,
     {"Run {}: no calibration date stated: {}.", "Прогон {}: не указана дата поверки: {}."}},
    {Text::kRemarkNoOperator,
     {"Run {}: no operator is recorded.", "Прогон {}: оператор не записан."}},
    {Text::kRemarkNoGyro,
     {"Run {}: no serial number of the gyro is recorded.",
      "Прогон {}: заводской номер гироскопа не записан."}},
    {Text::kRemarkNoFit, {"Test {}: no coefficients: {}.", "Испытание {}: нет коэффициентов: {}."}},
    {Text::kRemarkFit, {"Test {}: {}.", "Испытание {}: {}."}},
};

constexpr Named kQuantities[] = {
    {"bias", {"bias", "смещение нуля"}},
    {"temperature_linear", {"temperature, linear", "температура, линейный член"}},
    {"temperature_quadratic", {"temperature, quadratic", "температура, квадратичный член"}},
    {"temperature_cubic", {"temperature, cubic", "температура, кубический член"}},
    {"temperature_rate", {"rate of temperature change", "скорость изменения температуры"}},
    {"temperature_gradient", {"temperature gradient", "градиент температуры"}},
    {"magnetic_linear_x", {"magnetic field along OX", "магнитное поле вдоль OX"}},
    {"magnetic_linear_y", {"magnetic field along OY", "магнитное поле вдоль OY"}},
    {"magnetic_linear_z", {"magnetic field along OZ", "магнитное поле вдоль OZ"}},
    {"K_x", {"K of OX, extreme levels", "K вдоль OX, по крайним уровням"}},
    {"K_y", {"K of OY, extreme levels", "K вдоль OY, по крайним уровням"}},
    {"K_z", {"K of OZ, extreme levels", "K вдоль OZ, по крайним уровням"}},
    {"temperature_sigma", {"σ at the set points", "σ на уставках"}},
    {"angle_random_walk", {"angle random walk N", "случайное блуждание угла N"}},
    {"bias_instability", {"bias instability B", "нестабильность смещения нуля B"}},
    {"rate_random_walk", {"rate random walk K", "случайное блуждание скорости K"}},
};

constexpr Named kUnits[] = {
    {"deg/h", {"°/h", "°/ч"}},
    {"deg/h per 100 uT", {"°/h per 100 µT", "°/ч на 100 мкТл"}},
    {"deg/h/degC", {"°/h/°C", "°/ч/°C"}},
    {"deg/h/degC^2", {"°/h/°C²", "°/ч/°C²"}},
    {"deg/h/degC^3", {"°/h/°C³", "°/ч/°C³"}},
    {"(deg/h)/(degC/h)", {"(°/h)/(°C/h)", "(°/ч)/(°C/ч)"}},
    {"deg/sqrt(h)", {"°/√h", "°/√ч"}},
    {"deg/h/sqrt(h)", {"°/h/√h", "°/ч/√ч"}},
    {"deg", {"°", "°"}},
};

constexpr Named kRoles[] = {
    {"thermostat", {"thermostat", "термостат"}},
    {"coil_horizontal", {"coil supply, horizontal pair", "источник тока, горизонтальная пара"}},
    {"coil_vertical", {"coil supply, vertical pair", "источник тока, вертикальная пара"}},
    {"magnetometer", {"magnetometer", "магнитометр"}},
    {"turntable", {"turntable", "поворотный стол"}},
    {"gyro", {"gyro", "гироскоп"}},
};

constexpr bool all_translated() {
  for (std::size_t i = 0; i < std::size(kTexts); ++i) {
    if (kTexts[i].which != static_cast<Text>(i) || !kTexts[i].phrase.complete()) return false;
  }
  for (const Named& named : kQuantities) {
    if (!named.phrase.complete()) return false;
  }
  for (const Named& named : kUnits) {
    if (!named.phrase.complete()) return false;
  }
  for (const Named& named : kRoles) {
    if (!named.phrase.complete()) return false;
  }
  return true;
}
static_assert(std::size(kTexts) == static_cast<std::size_t>(Text::kCount), "a text is not listed");
static_assert(all_translated(), "a text lacks a language, or is out of the order of enum Text");

template <std::size_t N>
const Named* find(const Named (&table)[N], std::string_view id) {
  const auto* found =
      std::find_if(std::begin(table), std::end(table), [id](const Named& n) { return n.id == id; });
  return found == std::end(table) ? nullptr : found;
}

template <std::size_t N>
std::string_view name_in(const Named (&table)[N], std::string_view id, Language language) {
  const Named* named = find(table, id);
  return named == nullptr ? id : named->phrase.in(language);
}

}  // namespace

std::string_view text(Text which, Language language) {
  return kTexts[static_cast<std::size_t>(which)].phrase.in(language);
}

std::string quantity_name(const std::string& quantity, Language language) {
  return std::string(name_in(kQuantities, quantity, language));
}

bool has_name(const std::string& quantity) {
  return find(kQuantities, quantity) != nullptr;
}

std::string unit_name(const std::string& unit, Language language) {
  return std::string(name_in(kUnits, unit, language));
}

std::string_view role_name(std::string_view role, Language language) {
  return name_in(kRoles, role, language);
}

std::string_view verdict_name(model::Conformity verdict, Language language) {
  switch (verdict) {
    case model::Conformity::kPass:
      return text(Text::kPass, language);
    case model::Conformity::kFail:
      return text(Text::kFail, language);
    case model::Conformity::kIndeterminate:
      break;
  }
  return text(Text::kIndeterminate, language);
}

std::string_view outcome_name(std::string_view outcome, Language language) {
  if (outcome == "completed") return text(Text::kCompleted, language);
  if (outcome == "aborted") return text(Text::kAborted, language);
  if (outcome == "failed") return text(Text::kFailed, language);
  return text(outcome == "under way" ? Text::kUnderWay : Text::kInterrupted, language);
}

std::string localised(std::string number, Language language) {
  std::replace(number.begin(), number.end(), '.', text(Text::kDecimalMark, language).front());
  return number;
}

}  // namespace fogbench::acceptance
