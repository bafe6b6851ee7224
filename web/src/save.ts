// Files that the user saves.

export function save(name: string, text: string): void {
  const url = URL.createObjectURL(new Blob([text], { type: "application/octet-stream" }));
  const link = document.createElement("a");
  link.href = url;
  link.download = name;
  link.click();
  // The browser has copied the content by then.
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}
