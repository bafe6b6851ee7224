// The library's own report in a frame as high as the report, so that the page scrolls and the frame does not. The frame takes over the
// page's policy, which lets the report's script run and no other.

import { useEffect, useMemo, useRef } from "preact/hooks";

export function Report({ html, title = "Report" }: { html: string; title?: string }) {
  const frame = useRef<HTMLIFrameElement>(null);
  const url = useMemo(() => URL.createObjectURL(new Blob([html], { type: "text/html" })), [html]);
  useEffect(() => () => URL.revokeObjectURL(url), [url]);
  return (
    <iframe ref={frame} class="report" title={title} src={url} allow="clipboard-write" onLoad={() => frame.current && follow(frame.current)} />
  );
}

/** Keeps a frame as high as its content; where the browser hides that, the frame scrolls. */
function follow(frame: HTMLIFrameElement): void {
  const content = frame.contentDocument?.documentElement;
  if (!content) return;
  const border = frame.offsetHeight - frame.clientHeight;
  const fit = () => { frame.style.height = `${content.offsetHeight + border}px`; };
  new ResizeObserver(fit).observe(content);
  fit();
}
