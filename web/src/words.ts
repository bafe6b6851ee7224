// Numbers in the format of the report.

export function count(number: number, noun: string): string {
  return `${number} ${noun}${number === 1 ? "" : "s"}`;
}

/** A size with two digits: "1.6 MB". */
export function size(bytes: number): string {
  const units = ["bytes", "kB", "MB", "GB"];
  const power = Math.min(3, Math.floor(Math.log10(Math.max(bytes, 1)) / 3));
  const value = bytes / 1000 ** power;
  return `${value < 10 && power > 0 ? value.toFixed(1) : Math.round(value)} ${units[power]}`;
}

/** Significant digits without trailing zeros. */
export function significant(value: number, digits = 4): string {
  return String(Number(value.toPrecision(digits)));
}

export function seconds(value: number): string {
  return `${significant(value)} s`;
}

/** A text with a capital letter and a full stop. */
export function sentence(text: string): string {
  return `${capital(text)}.`;
}

export function capital(text: string): string {
  return `${text.charAt(0).toUpperCase()}${text.slice(1)}`;
}

/** A value with the half width of its interval, both to the second digit of that: "1.239 ± 0.032". */
export function interval(value: number, half: number): string {
  const digits = Math.min(12, Math.max(0, 1 - Math.floor(Math.log10(half || 1))));
  return `${value.toFixed(digits)} ± ${half.toFixed(digits)}`;
}
